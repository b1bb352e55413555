// SPDX-License-Identifier: MIT
/// COPC outputs as a user makes them. tests/levels tests the choice of their levels, tests/readers that other programs
/// read them.
#include <algorithm>
#include <cstring>
#include <sstream>
#include <vector>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class Copc : public Tool {
 protected:
  /// Returns the lines of a file as text, sorted.
  std::vector<std::string> points_of(const std::string& file) {
    std::istringstream text(made("convert " + file + " text.csv --force --no-provenance", "text.csv"));
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) lines.push_back(line);
    std::ranges::sort(lines);
    return lines;
  }
  /// Writes `input` as COPC, which must hold the same points, and returns the file.
  std::string converted(const std::string& input, const std::string& options = "") {
    const std::string file = made("convert " + input + " out.copc.laz --force " + options, "out.copc.laz");
    EXPECT_EQ(points_of("out.copc.laz"), points_of(input)) << input;
    EXPECT_EQ(tool("verify " + input + " out.copc.laz").status, 0) << input;
    return file;
  }
  /// Writes a text file with one point per line.
  void write_points(const std::string& name, std::size_t count, const auto& line) {
    std::string text = "x y z intensity\n";
    for (std::size_t i = 0; i < count; ++i) text += line(i) + "\n";
    write(name, text);
  }
};

template <class T>
T number_at(const std::string& file, std::size_t at) {
  T value;
  std::memcpy(&value, file.data() + at, sizeof value);
  return value;
}

TEST_F(Copc, HasTheSameBytesForAnyThreadsMemoryOrderAndTiles) {
  made("generate tls once.las -n 80000");
  made("run once.las again.las --pipeline 'set(user_data = 7)'");
  made("convert once.las again.las in.las");  // two points at each place
  made("sort in.las sorted.las --axis z --no-provenance");
  made("tile in.las tiles/ --size 40 --no-provenance");
  const auto bytes = [&](const std::string& input, const std::string& options) {
    return made("convert " + input + " out.copc.laz --force --no-provenance " + options, "out.copc.laz");
  };
  const std::string expected = bytes("in.las", "--threads 1");
  EXPECT_TRUE(expected == bytes("in.las", "--threads 3 --memory 100M"));
  EXPECT_TRUE(expected == bytes("in.las", "--threads 1 --memory 80M"));
  EXPECT_TRUE(expected == bytes("sorted.las", ""));
  EXPECT_TRUE(expected == bytes("tiles/", ""));
}

TEST_F(Copc, HoldsThePointsOfHostileClouds) {
  write_points("one.txt", 1, [](std::size_t) { return std::string("1.5 2.5 3.5 7"); });
  write_points("equal.txt", 110'000,
               [](std::size_t i) { return std::string(i % 50 == 0 ? "1.5 2.5 3.5 0" : "1.5 2.5 3.5 1"); });
  write_points("line.txt", 110'000, [](std::size_t i) { return std::to_string(i % 5000) + " 0 0 1"; });
  write_points("outlier.txt", 110'000, [](std::size_t i) {
    return i == 0 ? std::string("1000000000 -1000000000 5 1")
                  : std::to_string(i % 700) + " " + std::to_string(i % 91) + " " + std::to_string(i % 13) + " 1";
  });
  for (const std::string name : {"one", "equal", "line", "outlier"}) {
    made("convert " + name + ".txt " + name + ".las");
    converted(name + ".las");
  }
  made("convert outlier.txt uneven.las --scale 10,0.5,0.25 --offset 0,0,0");
  converted("uneven.las");
}

TEST_F(Copc, OfNoPointsHasAnEmptyRoot) {
  made("generate terrain in.las -n 100");
  const std::string file = made("run in.las out.copc.laz --pipeline 'where(x < -5)' --no-provenance", "out.copc.laz");
  const auto root = number_at<std::uint64_t>(file, 375 + 54 + 40);
  ASSERT_LE(root + 32, file.size());
  EXPECT_EQ(file.substr(root, 32), std::string(32, '\0'));
  EXPECT_GT(number_at<double>(file, 375 + 54 + 24), 0) << "half the width of the cube";
}

TEST_F(Copc, StatesWhatTheFormatAsksFor) {
  made("generate terrain in.las -n 150000");
  const std::string file = converted("in.las", "--point-format 6");
  EXPECT_EQ(number_at<std::uint16_t>(file, 94), 375) << "bytes of the header";
  EXPECT_EQ(file[104] & 0x3f, 6);
  EXPECT_EQ(number_at<std::uint16_t>(file, 375 + 18), 1) << "the info record is the first";
  EXPECT_EQ(number_at<std::uint32_t>(file, 243), 1u) << "extended records";
  const auto hierarchy = number_at<std::uint64_t>(file, 235);
  EXPECT_EQ(file.substr(hierarchy + 2, 5), std::string("copc\0", 5));
  EXPECT_EQ(number_at<std::uint64_t>(file, 375 + 54 + 40), hierarchy + 60);
  EXPECT_EQ(hierarchy + 60 + number_at<std::uint64_t>(file, 375 + 54 + 48), file.size());
}

TEST_F(Copc, AgainDropsTheRecordsOfTheOldOne) {
  made("generate statue in.las -n 150000");
  const std::string once = made("convert in.las once.copc.laz --no-provenance", "once.copc.laz");
  EXPECT_TRUE(once == made("convert once.copc.laz twice.copc.laz --no-provenance", "twice.copc.laz"));
  const std::string laz = made("convert once.copc.laz plain.laz --no-provenance", "plain.laz");
  EXPECT_EQ(laz.find(std::string("copc\0", 5)), laz.npos);
  EXPECT_EQ(number_at<std::uint32_t>(laz, 243), 0u) << "extended records";
  EXPECT_TRUE(once == made("convert plain.laz back.copc.laz --no-provenance", "back.copc.laz"));
}

TEST_F(Copc, MapsPointFormatsOfOldFiles) {
  made("generate terrain plain.ply -n 5000");
  made(
      "run plain.ply old.las --las-version 1.2 --point-format 3 --pipeline "
      "'set(classification = 12, as=uint8) | set(classification = 2 where x < 500) | set(red = 65535, as=uint16) | "
      "set(green = 256, as=uint16) | set(blue = 0, as=uint16) | set(gps_time = y)'");
  made("convert old.las out.copc.laz");
  EXPECT_EQ(tool("verify old.las out.copc.laz").status, 0);
  const std::string file = contents(folder_ / "out.copc.laz");
  EXPECT_NEAR(number_at<double>(file, 375 + 54 + 56), 0, 1) << "the least GPS time";
  EXPECT_NEAR(number_at<double>(file, 375 + 54 + 64), 1000, 1) << "the greatest";
  made("convert out.copc.laz new.csv --keep x,classification,overlap,red,green,blue,gps_time", "new.csv");
  std::istringstream lines(contents(folder_ / "new.csv"));
  std::size_t classes = 0;
  for (std::string line; std::getline(lines, line);)
    if (line.find(",12,") != line.npos) {
      ++classes;
      EXPECT_NE(line.find(",12,1,65535,256,0,"), line.npos) << line;
    }
  EXPECT_GT(classes, 1000u);
}

TEST_F(Copc, RefusesWhatItCannotHold) {
  made("generate terrain in.las -n 100");
  refused(2, "convert in.las o.copc.laz --point-format 3", "COPC has the point formats 6, 7 and 8, not 3");
  refused(2, "convert in.las o.copc.laz --point-format 10", "COPC has the point formats 6, 7 and 8, not 10");
  refused(2, "convert in.las o.copc.laz --las-version 1.2", "COPC is LAS 1.4");
  refused(2, "sort in.las o.copc.laz", "in the order of nodes of an octree");
  refused(2, "run in.las o.copc.laz --pipeline normals --order sweep", "in the order of nodes of an octree");
  EXPECT_FALSE(exists("o.copc.laz"));
}

TEST_F(Copc, IsReadByLevels) {
  made("generate statue in.las -n 250000");
  made("convert in.las a.copc.laz");
  std::size_t before = 0;
  for (const int depth : {0, 1, 2}) {
    const std::string option = " --depth " + std::to_string(depth);
    const std::vector<std::string> points =
        (made("convert a.copc.laz some.las --force" + option), points_of("some.las"));
    EXPECT_GT(points.size(), before) << depth;
    EXPECT_LE(points.size(), 250'001u - (depth < 2 ? 1 : 0)) << depth;
    EXPECT_EQ(tool("verify a.copc.laz some.las").status, 0) << "the record says the depth";
    before = points.size();
  }
  EXPECT_EQ(points_of("a.copc.laz --depth 31"), points_of("in.las"));
  // The statue is 2 wide, so the spacing is 2 / 128 in the root.
  EXPECT_EQ(points_of("a.copc.laz --resolution 0.02"), points_of("a.copc.laz --depth 0"));
  EXPECT_EQ(points_of("a.copc.laz --resolution 0.01"), points_of("a.copc.laz --depth 1"));
  EXPECT_NE(made("info a.copc.laz --depth 0", ".out").find("points      "), std::string::npos);
  EXPECT_EQ(tool("info --check a.copc.laz --depth 0").status, 0) << "the header is about all points";
  made("render a.copc.laz all.png --depth 31");
  const Result few = tool("render a.copc.laz few.png --size 100x80");
  EXPECT_NE(few.err.find(" of 250000 points"), std::string::npos) << few.err;
  refused(1, "convert in.las o.las --depth 1", "in.las: has no levels of detail");
  refused(1, "info in.las --resolution 1", "leave --resolution out");
  refused(2, "convert a.copc.laz o.las --depth 1.5", "--depth: '1.5' is no depth");
  refused(2, "convert a.copc.laz o.las --depth -1", "--depth: '-1' is no depth");
  refused(2, "convert a.copc.laz o.las --resolution 0", "--resolution: '0' is no distance above 0");
  refused(2, "convert a.copc.laz o.las --depth 1 --resolution 1", "leave one out");
}

TEST_F(Copc, IsReadWhereACropAsks) {
  made("generate terrain in.las -n 200000");
  made("convert in.las a.copc.laz");
  const auto cut = [&](const std::string& input, const std::string& pipeline) {
    made("run " + input + " cut.las --force --pipeline '" + pipeline + "'");
    return points_of("cut.las");
  };
  for (const std::string pipeline :
       {"crop([100,100,200,180])", "where(z > -100) | crop([100,100,600,180]) | crop([150,0,170,900])",
        "crop([400,400,600,600], outside=true)", "crop([0,0,1000,1000])", "crop([100,100,200,180]) | normals",
        "set(x = x + 600) | crop([700,100,800,200])"})
    EXPECT_EQ(cut("a.copc.laz", pipeline), cut("in.las", pipeline)) << pipeline;
  made("run a.copc.laz none.las --pipeline 'crop([-5,-5,-1,-1])'");
  EXPECT_NE(made("info --quick none.las", ".out").find("points      0"), std::string::npos);
  const Result some = tool("run a.copc.laz cut.las --force --pipeline 'crop([100,100,200,180])'");
  EXPECT_EQ(some.err.find("of 200000"), std::string::npos) << some.err;
  const Result all = tool("run a.copc.laz cut.las --force --pipeline 'crop([100,100,200,180]) | where(row < 100000)'");
  EXPECT_NE(all.err.find("of 200000"), std::string::npos) << "rows are counted in the file: " << all.err;
}

TEST_F(Copc, IsVerifiedAfterEveryKindOfStage) {
  made("generate terrain in.las -n 3000");
  for (const std::string pipeline :
       {"where(z > 0) | normals", "voxel(20)", "poisson(9)", "unique", "sample(1000)", "level",
        "ground(cell=20) | height", "normals | orient", "color(z)", "statistics(z_range, count)"}) {
    made("run in.las out.copc.laz --force --pipeline '" + pipeline + "'");
    EXPECT_EQ(tool("verify in.las out.copc.laz").status, 0) << pipeline;
  }
}

TEST_F(Copc, IsVerifiedAfterPointsHaveMovedWhereTheyCanBeToldApart) {
  made("generate terrain plain.las -n 20000");
  made("run plain.las timed.las --pipeline 'set(gps_time = row)'");
  for (const std::string input : {"timed.las", "plain.las"}) {
    made("run " + input + " out.copc.laz --force --pipeline 'transform(translate=[1000,0,0]) | set(z = z + 1)'");
    const Result result = tool("verify " + input + " out.copc.laz");
    EXPECT_EQ(result.status, input == "timed.las" ? 0 : 3) << result.out;
    made("run " + input + " tiles/ --force --tile 300 --pipeline 'transform(translate=[1000,0,0])'");
    EXPECT_EQ(tool("verify " + input + " tiles/").status, input == "timed.las" ? 0 : 3);
  }
}

TEST_F(Copc, StatesInADryRunWhatItPutsAside) {
  made("generate terrain in.las -n 1000");
  EXPECT_EQ(made("convert in.las out.copc.laz --dry-run", ".out").find("aside"), std::string::npos)
      << "memory holds them";
  made("generate terrain large.las -n 3000000");
  const std::string text = made("convert large.las out.copc.laz --dry-run --memory 100M", ".out");
  const std::size_t at = text.find("aside         up to ");
  ASSERT_NE(at, std::string::npos) << text;
  EXPECT_GT(std::stod(text.substr(at + 20)), 3e6 * 30 / (1 << 20)) << "more than the records";
  EXPECT_EQ(made("convert large.las out.laz --dry-run --memory 100M", ".out").find("aside"), std::string::npos);
}

TEST_F(Copc, BecomesAnOlderLasWithoutItsHierarchy) {
  made("generate terrain in.las -n 1000");
  made("convert in.las in.copc.laz");
  made("convert in.copc.laz old.las --las-version 1.2 --point-format 1");
  EXPECT_EQ(tool("verify in.copc.laz old.las").status, 0);
}

TEST_F(Copc, IsMadeByAResumedRun) {
  made("generate tls in.las -n 150000");
  const std::string expected = made("normals in.las a.copc.laz --no-provenance", "a.copc.laz");
  EXPECT_TRUE(expected == made("normals in.las b.copc.laz --no-provenance --resume r", "b.copc.laz"));
}

}  // namespace
}  // namespace pointsweep
