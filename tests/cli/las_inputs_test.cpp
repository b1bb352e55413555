// SPDX-License-Identifier: MIT
/// Several LAS files of different kinds as one cloud, by the tool.
#include <set>
#include <string>
#include <vector>

#include "tests/cli/tool.h"
#include "tests/formats/las_decode.h"

namespace pointsweep {
namespace {

std::string geotiff_vlr_of(std::uint16_t code) {
  const std::uint16_t keys[] = {1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, code};
  return las_test::vlr("LASF_Projection", 34735, {reinterpret_cast<const char*>(keys), sizeof keys});
}

class LasInputs : public Tool {
 protected:
  /// Writes 400 random points within about 10 m. Flags and numbers are random as well.
  void write_las(const std::string& name, int format, double scale, std::vector<std::string> vlrs = {}) {
    las_test::File file;
    file.format = format;
    file.minor = format >= 6 ? 4 : 2;
    file.count = 400;
    file.seed = static_cast<unsigned>(format) + 1;
    file.scale = {scale, scale, scale};
    file.offset = {0, 0, 0};
    file.vlrs = std::move(vlrs);
    std::string bytes = file.bytes();
    bytes[6] = static_cast<char>(format >= 6 ? 16 : 0);
    bytes[7] = 0;
    for (std::size_t i = 0; i < file.count; ++i) {
      for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t at = file.points_at() + i * file.record_length() + 4 * a;
        const double meters = las_test::get<std::int32_t>(bytes, at) / 2147483648.0 * 5;
        las_test::put(bytes, at, static_cast<std::int32_t>(meters / scale));
      }
    }
    for (std::size_t a = 0; a < 3; ++a) {
      las_test::put(bytes, 179 + 16 * a, 5.0);
      las_test::put(bytes, 187 + 16 * a, -5.0);
    }
    write(name, bytes);
  }
};

TEST_F(LasInputs, OfDifferentCoordinateSystemsAreRefusedUnlessToldOtherwise) {
  write_las("a.las", 1, 0.01, {geotiff_vlr_of(26910)});
  write_las("b.las", 1, 0.01, {geotiff_vlr_of(26911)});
  for (const char* verb : {"normals a.las b.las -o out.las", "sort a.las b.las -o out.las",
                           "run --pipeline 'knn(k=8) | normals' a.las b.las -o out.las --dry-run",
                           "run --pipeline 'knn(k=8) | normals' a.las b.las -o out.las"})
    refused(2, verb, "a.las is in EPSG:26910 and b.las in EPSG:26911");
  EXPECT_FALSE(exists("out.las"));
  const Result result = tool("normals a.las b.las -o out.las --ignore-crs");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("--ignore-crs: coordinates of b.las (EPSG:26911) are merged"), std::string::npos);
  refused(2, "verify a.las b.las out.las", "EPSG:26911");
  EXPECT_EQ(tool("verify a.las b.las out.las --ignore-crs").status, 0);
}

TEST_F(LasInputs, OfDifferentKindsPassTheirCheckInBothOrdersInMemoryAndSpilled) {
  write_las("a.las", 1, 0.01);
  write_las("b.las", 3, 0.001);
  write_las("c.las", 6, 0.01);
  for (const char* options : {"", "--order sweep", "--resume again"}) {
    const Result run = tool(std::string("normals a.las b.las c.las -o out.las -f ") + options);
    ASSERT_EQ(run.status, 0) << run.err;
    const las_test::Decoded out{contents(folder_ / "out.las")};
    EXPECT_EQ(out.format(), 7) << options;
    EXPECT_EQ(out.scale(0), 0.001);
    EXPECT_EQ(out.extra_names(), (std::vector<std::string>{"NormalX", "NormalY", "NormalZ"}));
    const Result check = tool("verify a.las b.las c.las out.las");
    EXPECT_EQ(check.status, 0) << options << check.out << check.err;
  }
}

TEST_F(LasInputs, OfDifferentKindsKeepWhatIsNamedAndZeroTheRest) {
  write_las("a.las", 1, 0.01);
  write_las("b.las", 3, 0.001);
  write_las("c.las", 6, 0.01);
  for (const std::string order : {"", " --order sweep"}) {
    made("normals a.las b.las c.las -o all.las -f" + order);
    made("normals a.las b.las c.las -o kept.las -f --keep nx,classification,gps_time" + order);
    const las_test::Decoded all{contents(folder_ / "all.las")}, kept{contents(folder_ / "kept.las")};
    EXPECT_EQ(kept.extra_names(), std::vector<std::string>{"NormalX"});
    EXPECT_EQ(kept.scale(0), all.scale(0));
    ASSERT_EQ(kept.count(), all.count());
    const std::set<std::string> named = {"x", "y", "z", "classification", "gps_time"};
    for (std::size_t i = 0; i < all.count(); ++i) {
      las_test::Values expected = all.point(i);
      for (auto& [name, value] : expected)
        if (!named.contains(name)) value = name == "return_number" || name == "number_of_returns" ? 1 : 0;
      const las_test::Values values = kept.point(i);
      for (const auto& [name, value] : values) ASSERT_EQ(value, expected[name]) << name;
    }
    const Result check = tool("verify kept.las --sample 50");
    EXPECT_EQ(check.status, 0) << check.out << check.err;
  }
}

TEST_F(LasInputs, PointsOfOtherFormatsAmongThemAreReturnOneOfOne) {
  write_las("a.las", 1, 0.01);
  write_las("b.las", 6, 0.01);
  write("c.csv", "x,y,z,intensity\n0.5,1.25,2,7\n3,2,1,9\n");
  write("d.csv", "x,y,z,return_number,number_of_returns\n1.5,1.25,2,2,3\n");
  made("sort c.csv c.ply --axis x");
  for (const std::string inputs :
       {"a.las c.csv d.csv", "c.ply b.las d.csv", "a.las b.las c.ply d.csv", "c.csv d.csv"}) {
    for (const std::string sweep : {"sort", "normals", "normals --order sweep"}) {
      const las_test::Decoded out{made(sweep + " " + inputs + " -o out.las -f", "out.las")};
      const std::string said = tool(sweep + " " + inputs + " -o out.las -f").err;
      EXPECT_EQ(said.find("return"), std::string::npos) << said;
      std::size_t ones = 0, twos = 0;
      for (std::size_t i = 0; i < out.count(); ++i) {
        const las_test::Values v = out.point(i);
        if ((v.at("x") == 0.5 && v.at("intensity") == 7) || (v.at("x") == 3 && v.at("intensity") == 9))
          ones += v.at("return_number") == 1 && v.at("number_of_returns") == 1;
        twos += v.at("x") == 1.5 && v.at("y") == 1.25 && v.at("return_number") == 2 && v.at("number_of_returns") == 3;
      }
      EXPECT_EQ(ones, 2u) << sweep << " " << inputs;
      EXPECT_EQ(twos, 1u) << sweep << " " << inputs;
      EXPECT_EQ(tool("verify out.las --sample 20").status, 0) << sweep << " " << inputs;
    }
  }
}

TEST_F(LasInputs, OfOldPointFormatsGetTheOverlapFlagForClassTwelveBesideNewOnes) {
  write_las("a.las", 1, 0.01);
  write_las("b.las", 6, 0.01);
  const las_test::Decoded old{contents(folder_ / "a.las")}, recent{contents(folder_ / "b.las")};
  const las_test::Decoded out{made("normals a.las b.las -o out.las", "out.las")};
  ASSERT_EQ(out.count(), 800u);
  std::size_t overlaps = 0;
  for (std::size_t i = 0; i < 400; ++i) {
    const double expected = old.point(i).at("classification") == 12 ? 1 : 0;
    overlaps += expected == 1;
    ASSERT_EQ(out.point(i).at("overlap"), expected);
    ASSERT_EQ(out.point(i).at("classification"), old.point(i).at("classification"));
    ASSERT_EQ(out.point(400 + i).at("overlap"), recent.point(i).at("overlap"));
  }
  EXPECT_GT(overlaps, 3u);
  EXPECT_EQ(tool("verify out.las --sample 20").status, 0);
}

TEST_F(LasInputs, DescribeWhatWasMade) {
  write_las("a.las", 1, 0.01);
  const std::string run = "run --pipeline 'knn(k=8) | normals | curvature' a.las -o out.las";
  const las_test::Decoded out{made(run, "out.las")};
  const std::vector<std::string> names = out.extra_names();
  const std::string vlr = out.vlr("LASF_Spec", 4);
  ASSERT_GT(names.size(), 4u);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string description = vlr.substr(192 * i + 160, 32).c_str();
    EXPECT_GT(description.size(), 3u) << names[i];
    if (names[i] == "k1") {
      EXPECT_EQ(description, "larger principal curvature");
    } else if (names[i] == "NormalX") {
      EXPECT_EQ(description, "unit surface normal, x");
    }
  }
}

}  // namespace
}  // namespace pointsweep
