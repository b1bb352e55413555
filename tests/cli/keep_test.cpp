// SPDX-License-Identifier: MIT
/// Options that the verbs over a cloud share: --keep, --dry-run, --orient, --temp-dir.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <sstream>
#include <vector>

#include "pointsweep/reader.h"
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

using Table = std::map<std::string, std::vector<double>>;  ///< values by column

class SharedOptions : public Tool {
 protected:
  /// Writes a wavy surface with attributes that LAS knows, and one that LAS does not know.
  SharedOptions() {
    std::string text = "x,y,z,intensity,classification,weight\n";
    for (int i = 0; i < 900; ++i) {
      const double x = i % 30 + 0.25 * std::sin(i * 1.7), y = i / 30 + 0.25 * std::cos(i * 2.3);
      text += fmt::format("{:.3f},{:.3f},{:.3f},{},{},{}\n", x, y, std::sin(x / 4) + std::cos(y / 5), i * 7 % 500,
                          i % 6, i * 0.5);
    }
    write("in.csv", text);
    for (const char* format : {"ply", "las", "xyz"}) made(std::string("sort in.csv in.") + format);
  }

  Table table(const std::string& name) const {
    const auto reader = open_reader(folder_ / name);
    const Schema& schema = reader->info().schema;
    std::vector<std::byte> records(reader->info().count * schema.stride);
    EXPECT_EQ(reader->read(0, records), reader->info().count);
    Table columns;
    for (const Field& field : schema.fields)
      for (std::size_t at = 0; at < records.size(); at += schema.stride)
        columns[field.name].push_back(value_of(field, records.data() + at));
    return columns;
  }
  std::string names(const std::string& file) const {
    const auto reader = open_reader(folder_ / file);
    std::string text;
    for (const Field& field : reader->info().schema.fields) text += (text.empty() ? "" : " ") + field.name;
    return text;
  }
  /// Converts values of text files back to float32. Text has the fewest digits that tell float32 values apart.
  static std::vector<float> singles(const std::vector<double>& values) { return {values.begin(), values.end()}; }
  void expect_columns_of(const Table& all, const Table& kept) const {
    for (const auto& [name, values] : kept) EXPECT_EQ(values, all.at(name)) << name;
  }
};

TEST_F(SharedOptions, KeepTakesColumnsOfTheOutputAndAttributesOfTheInput) {
  for (const std::string order : {"", " --order sweep"}) {
    for (const std::string format : {"ply", "xyz", "csv"}) {
      made("normals in." + format + " all." + format + " -f" + order);
      made("normals in." + format + " kept." + format + " -f --keep x,y,z,classification,nx" + order);
      EXPECT_EQ(names("kept." + format), "x y z classification nx");
      expect_columns_of(table("all." + format), table("kept." + format));
    }
  }
}

TEST_F(SharedOptions, WhatIsNotKeptOfLasStandardFieldsIsZero) {
  for (const std::string in : {"in.las", "in.ply"}) {
    made("normals " + in + " all.las -f");
    made("normals " + in + " kept.las -f --keep classification,nx");
    const Table all = table("all.las"), kept = table("kept.las");
    for (const char* name : {"x", "y", "z", "classification", "NormalX"})
      EXPECT_EQ(kept.at(name), all.at(name)) << name;
    for (const char* name : {"weight", "NormalY", "NormalZ"}) EXPECT_FALSE(kept.contains(name)) << name;
    for (const double value : kept.at("intensity")) ASSERT_EQ(value, 0);
  }
}

TEST_F(SharedOptions, NamesOfEitherKindLeaveTheOtherKindWhole) {
  made("normals in.ply a.ply --keep classification");
  EXPECT_EQ(names("a.ply"), "x y z classification nx ny nz");
  made("normals in.ply b.ply --keep normal");
  EXPECT_EQ(names("b.ply"), "x y z intensity classification weight nx ny nz");
  made("normals in.ply c.ply --keep NormalX,NZ");
  EXPECT_EQ(names("c.ply"), "x y z intensity classification weight nx nz");
  made("curvature in.ply d.ply --keep curvature,x");
  EXPECT_EQ(names("d.ply"), "x y z surface_variation");
  made("normals in.ply e.ply --keep x,y,z,intensity,classification,weight,normal");
  EXPECT_EQ(contents(folder_ / "e.ply"), made("normals in.ply f.ply", "f.ply"));
}

TEST_F(SharedOptions, APartOfAnAttributeThatTheInputHasTakesItsPlaceWhole) {
  made("normals in.ply old.ply --orient up");
  made("normals old.ply new.ply -k 20 --keep nx");
  EXPECT_EQ(names("new.ply"), "x y z intensity classification weight nx") << "no old ny, nz beside a new nx";
  made("normals in.ply whole.ply -k 20");
  EXPECT_EQ(table("new.ply").at("nx"), table("whole.ply").at("nx"));
}

TEST_F(SharedOptions, KeptCoordinatesAreTheMovedOnes) {
  made("fair in.ply all.ply -k 12");
  made("fair in.ply kept.ply -k 12 --keep x,y,z");
  EXPECT_EQ(names("kept.ply"), "x y z");
  expect_columns_of(table("all.ply"), table("kept.ply"));
  EXPECT_NE(table("kept.ply").at("z"), table("in.ply").at("z"));
  for (const std::string order : {"", " --order sweep"}) {
    made("fair in.ply whole.ply -f -k 12" + order);
    for (const std::string name : {"normal", "nx", "nx,intensity", "splat_length", "intensity"}) {
      made("fair in.ply kept.ply -f -k 12 --keep " + name + order);
      EXPECT_LT(table("kept.ply").size(), table("whole.ply").size()) << name;
      expect_columns_of(table("whole.ply"), table("kept.ply"));
      EXPECT_EQ(tool("verify kept.ply --sample 50").status, 0) << name;
    }
  }
  made("generate statue float32.ply -n 900");
  made("fair float32.ply all.ply -f -k 12");
  made("fair float32.ply kept.ply -f -k 12 --keep x,y,z,nx");
  EXPECT_EQ(names("kept.ply"), "x y z nx");
  expect_columns_of(table("all.ply"), table("kept.ply"));
}

/// The operator segments makes three attributes. Some of them are kept, some are read by a later stage.
TEST_F(SharedOptions, KeptValuesOfSegmentsAreThoseOfAll) {
  const std::string segments = "run in.ply {} -f -q --pipeline 'knn(k=12) | normals | segments(angle=2){}'{}";
  for (const std::string rows : {"", " | where(segment_residual < 0.64 && segment_size > 2)"}) {
    for (const std::string order : {"", " --order sweep"}) {
      made(fmt::format(fmt::runtime(segments), "whole.ply", rows, order));
      ASSERT_GT(table("whole.ply").at("x").size(), 400u) << rows;
      for (const std::string name :
           {"segment_residual", "segment", "segment_size,segment_residual", "intensity", "nx"}) {
        made(fmt::format(fmt::runtime(segments), "kept.ply", rows, order + " --keep " + name));
        EXPECT_LT(table("kept.ply").size(), table("whole.ply").size()) << name;
        expect_columns_of(table("whole.ply"), table("kept.ply"));
        if (order.empty()) {
          EXPECT_NE(tool("verify kept.ply").status, 1) << name << rows << ": 3 where rounding decides";
        }
      }
    }
  }
}

TEST_F(SharedOptions, KeepTakesNamesWithAndWithoutThePrefixOfTheOutput) {
  made("curvature in.ply all.ply --prefix my_ -k 12");
  for (const std::string format : {"ply", "csv", "las"}) {
    const std::string end = "." + format + " -f -k 12 --prefix my_ --keep ", out = "kept." + format;
    made("curvature in.ply kept" + end + "my_nx,my_surface_variation,MY_K1,intensity");
    const Table all = table("all.ply"), kept = table(out);
    for (const char* name : {"my_nx", "my_surface_variation", "my_k1", "intensity"})
      EXPECT_EQ(singles(kept.at(name)), singles(all.at(name))) << name;
    for (const char* name : {"my_ny", "my_k2", "weight", "nx"}) EXPECT_FALSE(kept.contains(name)) << name;
    const std::string bytes = contents(folder_ / out);
    EXPECT_EQ(made("curvature in.ply kept" + end + "nx,surface_variation,k1,intensity", out), bytes);
    made("normals in.ply kept" + end + "my_normal");
    for (const char* name : {"my_nx", "my_ny", "my_nz", "weight"}) EXPECT_TRUE(table(out).contains(name)) << name;
  }
  made("curvature in.ply kept.ply -f -k 12 --prefix my_ --keep my_nx,my_k1,intensity");
  EXPECT_EQ(tool("verify kept.ply --sample 50").status, 0);
  EXPECT_EQ(
      tool("verify in.ply kept.ply -k 12 --pipeline 'normals|curvature' --prefix my_ --keep my_nx,my_k1,intensity "
           "--sample 50")
          .status,
      0);
  refused(2, "normals in.ply out.ply --prefix my_ --keep your_nx", "'your_nx' cannot be kept");
  refused(2, "fair in.ply out.ply --prefix my_ --keep my_x", "'my_x' cannot be kept");
}

TEST_F(SharedOptions, KeptWithAPrefixAnAttributeOfTheInputIsNotTheMadeOne) {
  made("normals in.ply old.ply --orient up");
  made("normals old.ply both.ply -k 20 --prefix my_ --keep my_nz");
  EXPECT_EQ(names("both.ply"), "x y z intensity classification weight nx ny nz my_nz");
  EXPECT_EQ(table("both.ply").at("nx"), table("old.ply").at("nx"));
  made("normals old.ply whole.ply -k 20 --prefix my_");
  expect_columns_of(table("whole.ply"), table("both.ply"));
}

/// The input already has a curvature and normals, both as bytes.
TEST_F(SharedOptions, AReplacedAttributeIsKeptAsItIsMade) {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 300\nproperty float x\nproperty float y\nproperty float z\nproperty uchar "
      "curvature\nproperty uchar red\nproperty char nx\nproperty char ny\nproperty char nz\nend_header\n";
  for (int i = 0; i < 300; ++i)
    text += fmt::format("{} {} {:.4f} 5 {} 1 0 0\n", i % 20, i / 20, std::sin(i * 0.2), i % 251);
  write("bytes.ply", text);
  made("sort bytes.ply plain.ply --keep red --axis z");
  made("curvature plain.ply expected.ply --order sweep --axis z");
  const Table expected = table("expected.ply");
  for (const std::string keep : {"", " --keep surface_variation,nz"}) {
    for (const std::string out : {"replaced.ply", "replaced.csv", "replaced.las"}) {
      made("curvature bytes.ply " + out + " -f --order sweep --axis z --replace curvature" + keep);
      const Table replaced = table(out);
      const bool las = out.ends_with("las");
      EXPECT_EQ(singles(replaced.at(las ? "Curvature" : "curvature")), singles(expected.at("surface_variation")))
          << out << keep;
      EXPECT_EQ(singles(replaced.at(las ? "NormalZ" : "nz")), singles(expected.at("nz"))) << out << keep;
    }
  }
  refused(2, "curvature bytes.ply out.ply --replace curvature --keep k1", "leave it out");
}

TEST_F(SharedOptions, WithoutNonfinitePointsKeepLeavesTheSameColumnsOfTheOthers) {
  std::string dirty = "x,y,z,intensity,classification,weight\n", clean = dirty;
  std::istringstream rows(contents(folder_ / "in.csv"));
  std::string row;
  std::getline(rows, row);
  for (int i = 0; std::getline(rows, row); ++i) {
    const bool lost = i % 97 == 5;
    dirty += lost ? (i % 2 == 0 ? "nan" : "inf") + row.substr(row.find(',')) + "\n" : row + "\n";
    if (!lost) clean += row + "\n";
  }
  write("dirty.csv", dirty);
  write("clean.csv", clean);
  for (const std::string verb : {"normals", "fair -k 12", "sort"}) {
    const std::string keep = verb == "sort" ? " --keep weight" : " --keep weight,nx,classification";
    for (const std::string format : {"ply", "csv", "las"}) {
      for (const std::string order : {"", verb == "sort" ? "" : " --order sweep"}) {
        const std::string end = " -f --no-provenance --nonfinite drop" + keep + order;
        EXPECT_EQ(made(verb + " dirty.csv a." + format + end, "a." + format),
                  made(verb + " clean.csv b." + format + end, "b." + format))
            << verb << order;
      }
    }
  }
}

TEST_F(SharedOptions, KeepServesSeveralInputsSweepsEnginesAndJson) {
  made("sort in.csv other.ply --keep classification --axis x");
  EXPECT_EQ(names("other.ply"), "x y z classification");
  const std::string pipeline = " --pipeline 'normals | splats | fair(f=2, g=2) | reneighbor | normals'";
  for (const std::string order : {"", " --order sweep"}) {
    made("run in.ply other.ply -o all.ply -f" + pipeline + order);
    made("run in.ply other.ply -o kept.ply -f --keep classification,nz,position" + pipeline + order);
    EXPECT_EQ(names("kept.ply"), "classification nz x y z");
    expect_columns_of(table("all.ply"), table("kept.ply"));
  }
  const std::string text = made("run in.ply a.ply --keep weight,ny --pipeline 'knn(k=9) | normals'", "a.ply");
  EXPECT_EQ(names("a.ply"), "x y z weight ny");
  EXPECT_EQ(made("run in.ply b.ply --keep weight,ny --pipeline '[{\"type\": \"knn\", \"k\": 9}, "
                 "{\"type\": \"normals\"}]'",
                 "b.ply"),
            text);
  EXPECT_EQ(made("normals in.ply c.ply -k 9 --keep weight,ny --resume folder", "c.ply"), text);
  made("normals in.ply d.ply -k 9 --keep weight,ny --engine reference", "d.ply");
  EXPECT_EQ(names("d.ply"), "x y z weight ny");
}

TEST_F(SharedOptions, KeepOfUnknownNamesIsRefusedWithTheNearest) {
  refused(2, "normals in.ply out.ply --keep intensty", "'intensty' cannot be kept (did you mean 'intensity'?)");
  refused(2, "normals in.ply out.ply --keep colour",
          "the input has x, y, z, intensity, classification, weight, and "
          "what is made is normal");
  refused(2, "sort in.ply out.ply --keep nx", "'nx' cannot be kept");
  refused(2, "neighbors in.ply out.npy --keep nx", "'nx' is not neighbors or distances");
  EXPECT_FALSE(exists("out.ply") || exists("out.npy"));
}

TEST_F(SharedOptions, KeepChoosesTheArraysOfNeighbors) {
  made("neighbors in.ply a.npy -k 3 --distances d.npy");
  EXPECT_EQ(made("neighbors in.ply b.npy -k 3 --keep distances", "b.npy"), contents(folder_ / "d.npy"));
  EXPECT_EQ(made("neighbors in.ply c.npy -k 3 --keep neighbors", "c.npy"), contents(folder_ / "a.npy"));
  made("neighbors in.ply e.npy -k 3 --keep neighbors,distances --distances f.npy");
  EXPECT_EQ(contents(folder_ / "f.npy"), contents(folder_ / "d.npy"));
  refused(2, "neighbors in.ply g.npy --keep distances --distances h.npy", "leave out --distances");
  refused(2, "neighbors in.ply g.npy --keep neighbors,distances", "--distances");
}

TEST_F(SharedOptions, EveryVerbOverACloudHasADryRun) {
  for (const std::string verb : {"normals", "curvature", "splats", "fair", "run --pipeline normals", "sort"}) {
    const Result result = tool(verb + " in.ply out.ply --dry-run --keep classification --memory 200M");
    EXPECT_EQ(result.status, 0) << result.err;
    for (const char* words : {"points        900", "slabs", "of 200.0 MB"})
      EXPECT_NE(result.out.find(words), std::string::npos) << verb << "\n" << result.out;
    EXPECT_FALSE(exists("out.ply")) << verb;
    refused(1, verb + " in.ply out.ply --dry-run --memory 1M", "too small");
    write("old.ply", "kept");
    const std::string over = verb + " in.ply old.ply --dry-run --keep classification",
                      note = "note          old.ply: exists already";
    EXPECT_THAT(made(over, ".out"), testing::HasSubstr(note)) << verb;
    EXPECT_THAT(made(over + " --force", ".out"), testing::Not(testing::HasSubstr(note))) << verb;
    EXPECT_EQ(contents(folder_ / "old.ply"), "kept") << verb;
  }
  const Result result = tool("neighbors in.ply out.npy --dry-run -k 5");
  EXPECT_NE(result.out.find("the 5 nearest"), std::string::npos) << result.out << result.err;
  EXPECT_FALSE(exists("out.npy"));
}

TEST_F(SharedOptions, EveryVerbThatMakesNormalsOrientsThem) {
  for (const std::string verb : {"normals", "curvature", "splats", "fair -k 12"}) {
    made(verb + " in.ply up.ply -f --orient up");
    made(verb + " in.ply down.ply -f --orient viewpoint --viewpoint 15,15,-1e6");
    const Table up = table("up.ply"), down = table("down.ply");
    for (const double nz : up.at("nz")) ASSERT_GT(nz, 0) << verb;
    for (const double nz : down.at("nz")) ASSERT_LT(nz, 0) << verb;
  }
  const std::string pipeline = "run in.ply out.ply -f --orient up --pipeline ";
  EXPECT_EQ(made(pipeline + "'knn(k=9) | normals'", "out.ply"), made("normals in.ply n.ply -k 9 --orient up", "n.ply"));
  refused(2, pipeline + "'normals(orient=input)'", "leave out --orient");
  refused(2, pipeline + "neighborhood_size", "makes no normals");
}

TEST_F(SharedOptions, ATemporaryFolderThatCannotBeUsedIsRefusedAtOnce) {
  write("file", "not a folder");
  for (const std::string verb :
       {"normals", "curvature", "sort", "run --pipeline normals", "sort --dry-run", "normals --dry-run"}) {
    refused(1, verb + " in.ply out.ply --temp-dir nowhere",
            "temporary folder 'nowhere' cannot be used: No such file or directory");
    refused(1, verb + " in.ply out.ply --temp-dir file", "it is not a folder; name a writable folder with --temp-dir");
    EXPECT_EQ(tool(verb + " in.ply out.ply -f --temp-dir .").status, 0);
    std::filesystem::remove(folder_ / "out.ply");
  }
  refused(1, "neighbors in.ply out.npy --temp-dir nowhere", "'nowhere' cannot be used");
}

TEST_F(SharedOptions, VerifyKnowsWhatWasKept) {
  const std::string keep = " --keep classification,nx";
  made("normals in.ply out.ply -k 9" + keep);
  const Result result = tool("verify in.ply out.ply -k 9 --pipeline normals" + keep);
  EXPECT_EQ(result.status, 0) << result.out << result.err;
  refused(1, "verify in.ply out.ply -k 9 --pipeline normals --keep classification,weight,nx -q", "'weight'");
  refused(1, "verify in.ply out.ply -k 9 --pipeline normals --keep classification,nx,ny -q", "'ny'");
  refused(1, "verify in.ply out.ply -k 12 --pipeline normals -q" + keep, "by brute force");
}

}  // namespace
}  // namespace pointsweep
