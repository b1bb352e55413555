// SPDX-License-Identifier: MIT
/// The layout of outputs as the user states it: --scale, --offset, --point-format, --las-version, --decimals.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "pointsweep/formats/las_scale.h"
#include "tests/cli/tool.h"
#include "tests/formats/point_files.h"

namespace pointsweep {
namespace {

constexpr const char* kCopy = " -q -f --pipeline 'decimate(1)' ";

class StatedLayout : public Tool {
 protected:
  StatedLayout() {
    std::string text = "x,y,z,intensity,classification,return_number,number_of_returns,gps_time\n";
    for (int i = 0; i < 500; ++i)
      text += fmt::format("{:.2f},{:.2f},{:.2f},{},{},1,2,{}\n", 684992.57 + i * 7919 % 9001 / 100.0,
                          4873411.13 + i * 6007 % 9001 / 100.0, i * 37 % 900 / 100.0, i * 101 % 60000, i % 3, i / 8.0);
    write("a.csv", text);
    made(std::string("run a.csv a.las") + kCopy);
  }
  std::vector<double> values(const std::string& file, const std::string& field) const {
    return values_of(*open_reader(folder_ / file), field);
  }
  bool has(const std::string& file, const std::string& field) const {
    return open_reader(folder_ / file)->info().schema.find(field).has_value();
  }
  LasQuantization grid(const std::string& file) const { return open_reader(folder_ / file)->info().las->grid; }
  std::string format(const std::string& file) const { return open_reader(folder_ / file)->info().format; }
  void expect_near(const std::string& file, double most) const {
    for (const char* axis : {"x", "y", "z"}) {
      const auto was = values("a.las", axis), is = values(file, axis);
      ASSERT_EQ(was.size(), is.size()) << file;
      for (std::size_t i = 0; i < was.size(); ++i) EXPECT_NEAR(was[i], is[i], most + 1e-9) << file << axis << i;
    }
  }
};

TEST_F(StatedLayout, TheScaleIsThatOfTheFileAndOneLineTellsWhatIsRounded) {
  made("run a.las a.ply" + std::string(kCopy));
  for (const char* in : {"a.las", "a.csv", "a.ply"})
    for (const char* out : {"out.las", "out.laz"})
      for (const auto& [option, scale, rounds] : {std::tuple{"0.001", Vec3{0.001, 0.001, 0.001}, false},
                                                  {"0.1", Vec3{0.1, 0.1, 0.1}, true},
                                                  {"0.25,0.01,1", Vec3{0.25, 0.01, 1}, true}}) {
        const Result result = tool(fmt::format("run {} {} -f --pipeline 'decimate(1)' --scale {}", in, out, option));
        ASSERT_EQ(result.status, 0) << result.err;
        EXPECT_EQ(grid(out).scale, scale) << in << out;
        EXPECT_EQ(result.err.find("coordinates are rounded to steps of") != std::string::npos, rounds) << result.err;
        expect_near(out, scale.z / 2);
        const Result check = tool(fmt::format("verify {} {}", in, out));
        EXPECT_EQ(check.status, 0) << check.out << check.err;
      }
}

TEST_F(StatedLayout, TheSmallestRoundingIsTold) {
  write("s.csv", "x,y,z\n5.0009,1,2\n6,1,2\n");
  for (const char* scale : {"1", "1000", "1e12"}) {
    const Result result = tool(fmt::format("run s.csv s.las -f --scale {}", scale));
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.err.find("coordinates are rounded to steps of"), std::string::npos) << scale << result.err;
  }
}

TEST_F(StatedLayout, TheOffsetIsKeptStatedOrNearTheMiddle) {
  made(std::string("run a.las b.las --scale 0.001") + kCopy);
  EXPECT_EQ(grid("b.las").offset.x, 0) << "that of the input reaches all points";
  made(std::string("run a.las c.las --offset auto") + kCopy);
  EXPECT_EQ(grid("c.las").offset, (Vec3{685040, 4873460, 0}));
  EXPECT_EQ(grid("c.las").scale, (Vec3{0.01, 0.01, 0.01}));
  expect_near("c.las", 0);
  made(std::string("run a.las d.las --scale 0.00001 --offset 685000,4873000,0") + kCopy);
  EXPECT_EQ(grid("d.las").offset, (Vec3{685000, 4873000, 0}));
  expect_near("d.las", 0);
  made(std::string("run a.csv e.las --offset 0,0,0") + kCopy);
  expect_near("e.las", 0);
}

TEST_F(StatedLayout, PointsOutOfReachAreRefusedWithTheRowTheValueAndAScale) {
  refused(
      1, std::string("run a.las o.las --scale 1e-6 --offset 0,0,0") + kCopy,
      "too far from the offset 0 for the scale 1e-06 of this LAS file; give --scale 0.001, which reaches all points,");
  refused(1, std::string("run a.las o.las --scale 1e-6 --offset 0,0,0") + kCopy, "x of row 0 is 684992.57");
  refused(1, std::string("run a.las o.laz --scale 1e-9") + kCopy, "give --scale 1e-07, which reaches all points,");
  made(std::string("run a.las o.las --scale 1e-7") + kCopy);
  refused(1, "run a.las p.las -q --scale 0.0001 --pipeline 'set(x = x + 1e9 where z > 8)'", "of row ");
  for (const char* wrong : {"0", "-1", "1,2", "x", "1,0,1", "nan"})
    refused(2, fmt::format("run a.las p.las --scale {} {}", wrong, kCopy), "--scale:");
  EXPECT_FALSE(exists("p.las"));
}

TEST_F(StatedLayout, AValueThatTheFormatCannotHoldIsNamedByItsRowInTheInput) {
  std::string text = "x,y,z\n";
  for (int i = 0; i < 300; ++i) text += fmt::format("{},0,0\n", 299 - i);
  write("ids.csv", text);
  write("first.csv", "x,y,z\n0,5,5\n");
  const std::string stages = " -f --pipeline 'set(id = 9007199254740993 where x == 205, as=int64) | where(x >= 100)' ";
  refused(1, "run ids.csv -o out.ply" + stages, "row 94: 'id' needs all of its 64 bits");
  refused(1, "run first.csv ids.csv -o out.ply" + stages, "row 94 of ");
  refused(1, "run ids.csv -o out.ply --order sweep" + stages, "row 105 of the output: 'id'");
  refused(1, "run first.csv ids.csv -o folder/ --output-format ply" + stages, "row 94 of ");
  refused(1, "run ids.csv -o cut/ --output-format ply --tile 1000" + stages, "row 94 of the output: 'id'");
  refused(1, "run ids.csv -o out.las -f --scale 1e-7 --offset 0,0,0 --pipeline 'where(x < 220)'",
          "x of row 80 is 219, too far");
}

TEST_F(StatedLayout, MovedPointsGetTheStatedScale) {
  const Result moved = tool("run a.las m.las --scale 0.001 --pipeline 'set(x = x + 512000.12345)'");
  EXPECT_NE(moved.err.find("moved coordinates are rounded to steps of 0.001, by at most 0.0005"), std::string::npos)
      << moved.err;
  EXPECT_EQ(grid("m.las").scale, (Vec3{0.001, 0.001, 0.001}));
  const auto was = values("a.las", "x"), is = values("m.las", "x");
  for (std::size_t i = 0; i < was.size(); ++i) EXPECT_NEAR(is[i], was[i] + 512000.12345, 0.00051);
  EXPECT_EQ(tool("verify m.las").status, 0);
}

TEST_F(StatedLayout, ADryRunRefusesWhatTheRunRefuses) {
  write("empty.csv", "x,y,z\n");
  for (const std::string run :
       {"convert empty.csv b.las", "normals empty.csv b.ply", "sort empty.csv b.ply", "convert a.las b.laz --memory 1M",
        "run a.las b.ply --pipeline 'where(z > 1)' --memory 9M"}) {
    const Result refusal = tool(run), dry = tool(run + " --dry-run");
    EXPECT_EQ(refusal.status, 1) << run << refusal.err;
    EXPECT_EQ(dry.status, 1) << run;
    EXPECT_EQ(dry.err, refusal.err) << run;
  }
  for (const std::string run :
       {"convert a.las b.las --las-version 1.2 --point-format 6", "convert a.las b.copc.laz --point-format 3",
        "convert a.csv b.copc.laz --las-version 1.2", "normals a.las b.laz --las-version 1.3 --point-format 7",
        "convert a.las b.ply --scale 1", "convert a.csv - --output-format las"}) {
    const Result refusal = tool(run), dry = tool(run + " --dry-run");
    EXPECT_EQ(refusal.status, 2) << run;
    EXPECT_EQ(dry.status, 2) << run;
    EXPECT_EQ(dry.err, refusal.err) << run;
  }
  for (const std::string run : {"convert a.las b.las --las-version 1.2 --point-format 3", "convert a.csv b.copc.laz",
                                "normals a.las b.laz --scale 0.5", "tile a.las out/ --size 30"})
    EXPECT_EQ(tool(run + " --dry-run").status, 0) << run;
}

TEST_F(StatedLayout, APointFormatWithoutAFieldKeepsItsValuesAsExtraBytes) {
  const Result result = tool("run a.las b.las --point-format 0 --las-version 1.2 --pipeline 'decimate(1)'");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("point format 0 has no field for gps_time; extra bytes hold the values."),
            std::string::npos)
      << result.err;
  EXPECT_NE(format("b.las").find("LAS 1.2 point format 0"), std::string::npos) << format("b.las");
  for (const char* name : {"x", "gps_time", "classification", "number_of_returns", "intensity"})
    EXPECT_EQ(values("b.las", name), values("a.las", name)) << name;
  EXPECT_FALSE(has("b.las", "overlap")) << "all 0, as in files without the field";
  EXPECT_EQ(tool("verify a.las b.las").status, 0) << tool("verify a.las b.las").err;
  made("run b.las back.laz --point-format 6 -q --pipeline 'decimate(1)'");
  EXPECT_NE(format("back.laz").find("LAZ 1.4 point format 6"), std::string::npos) << format("back.laz");
  EXPECT_EQ(values("back.laz", "gps_time"), values("a.las", "gps_time"));
  made("run a.las c.las -q --point-format 6 --pipeline 'color(z)'");
  EXPECT_NE(format("c.las").find("point format 6"), std::string::npos) << format("c.las");
  EXPECT_TRUE(has("c.las", "red"));
  EXPECT_EQ(tool("verify c.las").status, 0) << tool("verify c.las").err;
}

TEST_F(StatedLayout, AValueThatTheAskedForFieldCannotHoldIsKeptBesideIt) {
  made("run a.las b.las -q --pipeline 'set(classification = 200 where intensity > 30000)'");
  const Result result = tool("run b.las c.las --point-format 3 --pipeline 'decimate(1)'");
  EXPECT_NE(result.err.find("some values of 'classification' do not fit"), std::string::npos) << result.err;
  EXPECT_EQ(values("c.las", "classification_uint8"), values("b.las", "classification"));
  EXPECT_EQ(tool("verify b.las c.las").status, 0) << tool("verify b.las c.las").err;
}

TEST_F(StatedLayout, TheVersionChoosesAmongItsPointFormats) {
  for (const auto& [version, expected] : {std::pair{"1.2", "LAS 1.2 point format 1"},
                                          {"1.3", "LAS 1.3 point format 1"},
                                          {"1.4", "LAS 1.4 point format"}}) {
    made(fmt::format("run a.csv v.las --las-version {} {}", version, kCopy));
    EXPECT_NE(format("v.las").find(expected), std::string::npos) << format("v.las");
    EXPECT_EQ(tool("verify a.csv v.las").status, 0) << tool("verify a.csv v.las").err;
    EXPECT_EQ(values("v.las", "gps_time"), values("a.las", "gps_time"));
  }
  made(std::string("run v.las w.las --point-format 1 --las-version 1.2") + kCopy);
  made(std::string("run w.las u.las --las-version 1.4") + kCopy);
  EXPECT_NE(format("u.las").find("LAS 1.4 point format 1"), std::string::npos) << format("u.las");
  EXPECT_EQ(tool("verify w.las u.las").status, 0);
  refused(2, std::string("run a.las o.las --las-version 1.2") + kCopy,
          "LAS 1.2 has no point format 6, which needs LAS 1.4");
  refused(2, std::string("run a.csv o.las --las-version 1.2 --las-version 1.4") + kCopy,
          "--las-version is given more than once");
  refused(2, std::string("run a.csv o.las --las-version 1.3 --point-format 7") + kCopy,
          "LAS 1.3 has no point format 7");
  refused(2, std::string("run a.csv o.las --point-format 11") + kCopy, "--point-format: '11' is not 0, 1,");
}

TEST_F(StatedLayout, StandardGpsTimeIsNotTakenForGpsTimeOfTheWeek) {
  std::string bytes = contents(folder_ / "a.las");
  bytes[6] = static_cast<char>(bytes[6] | 1);  // the bit of the clock in the global encoding
  write("standard.las", bytes);
  ASSERT_TRUE(open_reader(folder_ / "standard.las")->info().las->standard_time);
  const std::string old = "run standard.las o.las --point-format 1 --las-version 1.";
  refused(2, old + "1" + kCopy,
          "LAS 1.1 knows only GPS time of the week, but the input has adjusted standard GPS time");
  made(old + "2" + kCopy);
  EXPECT_TRUE(open_reader(folder_ / "o.las")->info().las->standard_time);
  made(std::string("run standard.las o.las --point-format 0 --las-version 1.1 --keep x,y,z") + kCopy);
}

TEST_F(StatedLayout, OldVersionsTakePointFormatsThatTheyHave) {
  write("c.csv", "x,y,z,red,green,blue\n1,2,3,300,400,500\n2,3,4,301,401,501\n");
  for (const auto& [version, expected] :
       {std::pair{"1.1", "LAS 1.1 point format 0"}, {"1.2", "LAS 1.2 point format 2"}}) {
    made(fmt::format("run c.csv o.las --las-version {}{}", version, kCopy));
    EXPECT_EQ(format("o.las").find(expected), 0u) << format("o.las");
    EXPECT_EQ(values("o.las", "red"), (std::vector<double>{300, 301}));
  }
}

TEST_F(StatedLayout, TextHasTheStatedDecimals) {
  for (const char* out : {"out.csv", "out.xyz", "out.pts"}) {
    const Result result = tool(fmt::format("run a.las {} -f --decimals 1 --pipeline 'decimate(1)'", out));
    EXPECT_NE(result.err.find("coordinates are rounded to 1 digit after the decimal point"), std::string::npos);
    EXPECT_NE(contents(folder_ / out).find("684992.6"), std::string::npos) << out;
    expect_near(out, 0.05);
    EXPECT_EQ(tool(fmt::format("verify a.las {} --decimals 1", out)).status, 0) << out;
    EXPECT_EQ(tool(fmt::format("verify a.las {}", out)).status, out == std::string("out.csv") ? 1 : 0) << out;
    EXPECT_EQ(tool(fmt::format("run a.las {} -f --decimals 4 --pipeline 'decimate(1)'", out)).err.find("rounded"),
              std::string::npos);
    EXPECT_NE(contents(folder_ / out).find("684992.5700"), std::string::npos) << out;
    expect_near(out, 0);
  }
  refused(2, std::string("run a.las o.csv --decimals 16") + kCopy, "'16' is not a whole number from 0 to 15");
}

TEST_F(StatedLayout, AFormatWithoutAPlaceForAWishRefusesIt) {
  refused(2, std::string("run a.las o.ply --scale 0.1") + kCopy,
          "--scale: is for LAS, LAZ, COPC outputs, and o.ply is PLY");
  refused(2, std::string("run a.las o.csv --point-format 6") + kCopy, "--point-format: is for LAS, LAZ, COPC outputs");
  refused(2, std::string("run a.las o.las --decimals 2") + kCopy, "--decimals: is for text outputs, and o.las is LAS");
  refused(2, "sort a.las o.pcd --offset auto", "--offset: is for LAS, LAZ, COPC outputs");
  refused(2, "run a.las o.ply --las-version 1.2 --dry-run --pipeline 'decimate(1)'", "--las-version: is for LAS");
  std::filesystem::create_directory(folder_ / "tiles");
  std::filesystem::copy(folder_ / "a.las", folder_ / "tiles");
  refused(2, std::string("run tiles/ out/ --output-format ply --scale 0.1") + kCopy, "--scale: is for LAS, LAZ, COPC");
}

TEST_F(StatedLayout, TilesOrdersResumedRunsAndEmptyOutputsFollowIt) {
  std::filesystem::create_directory(folder_ / "tiles");
  made(std::string("run a.las tiles/w.las -q --pipeline 'where(x < 685030)'"));
  made(std::string("run a.las tiles/e.las -q --pipeline 'where(x >= 685030)'"));
  const std::string how = " --scale 0.05 --point-format 1 -q -f ";
  for (const char* pipeline : {"normals", "normals | set(z = z + 0.013)"}) {
    made(fmt::format("run tiles/ out/ {} --pipeline '{}'", how, pipeline));
    made(fmt::format("run tiles/ out/ {} --pipeline '{}' --memory 64M --threads 1", how, pipeline));
    made(fmt::format("run tiles/ one.laz {} --pipeline '{}' --order sweep", how, pipeline));
    std::size_t points = 0;
    for (const char* tile : {"out/w.las", "out/e.las", "one.laz"}) {
      EXPECT_EQ(grid(tile).scale, (Vec3{0.05, 0.05, 0.05})) << tile;
      EXPECT_NE(format(tile).find("point format 1"), std::string::npos) << format(tile);
      points += tile == std::string("one.laz") ? 0 : values(tile, "x").size();
    }
    EXPECT_EQ(points, 500u);
    for (const char* check : {"tiles/ out/", "tiles/ one.laz"})
      EXPECT_EQ(tool(fmt::format("verify {}", check)).status, 0) << check << tool(fmt::format("verify {}", check)).err;
  }
  const std::string plain = made(std::string("sort a.las s.laz -q --scale 0.1"), "s.laz");
  EXPECT_EQ(made("sort a.las s.laz -q -f --scale 0.1 --resume kept --memory 64M", "s.laz"), plain);
  EXPECT_EQ(grid("s.laz").scale, (Vec3{0.1, 0.1, 0.1}));
  made(std::string("run a.las none.las --scale 0.5 --point-format 3 --pipeline 'where(x < 0)' -q"));
  EXPECT_EQ(values("none.las", "x").size(), 0u);
  EXPECT_NE(format("none.las").find("point format 3"), std::string::npos) << format("none.las");
  write("nan.xyz", "1.234 2 3\nnan 5 6\n7 8 9.876\n");
  made("run nan.xyz nan.las --scale 0.1 -q --pipeline 'decimate(1)'");
  EXPECT_EQ(values("nan.las", "z"), (std::vector<double>{3, 9.9}));
  made("run nan.xyz nan.csv --decimals 1 -q --pipeline 'decimate(1)'");
  EXPECT_EQ(contents(folder_ / "nan.csv"), "x,y,z\n1.2,2.0,3.0\nnan,5.0,6.0\n7.0,8.0,9.9\n");
}

TEST_F(StatedLayout, ColumnsStandInTheOrderInWhichKeepNamesThem) {
  const auto columns = [&](const std::string& file, const std::string& before, char separator) {
    const std::string text = contents(folder_ / file);
    const std::size_t begin = text.find(before) + before.size();
    std::string line = text.substr(begin, text.find('\n', begin) - begin);
    std::ranges::replace(line, separator, ' ');
    return line;
  };
  std::filesystem::create_directory(folder_ / "tiles");
  std::filesystem::copy(folder_ / "a.las", folder_ / "tiles");
  for (const auto& [keep, expected] : {std::pair{"z,x", "x y z nx ny nz"},
                                       {"intensity,z,y,x", "intensity z y x nx ny nz"},
                                       {"nx,intensity", "x y z nx intensity"},
                                       {"intensity,nx", "x y z intensity nx"},
                                       {"normal,gps_time,x", "x y z nx ny nz gps_time"},
                                       {"GpsTime,nz,ny", "x y z gps_time nz ny"}}) {
    made(fmt::format("run a.las o.csv -q -f --keep {} --pipeline normals", keep));
    EXPECT_EQ(columns("o.csv", "", ','), expected) << keep;
    made(fmt::format("run tiles/ out/ --output-format csv -q -f --keep {} --pipeline normals", keep));
    EXPECT_EQ(columns("out/a.csv", "", ','), expected) << keep;
    for (const char* order : {"input", "sweep"}) {
      made(fmt::format("run a.las o.pcd -q -f --order {} --keep {} --pipeline normals", order, keep));
      std::string names = columns("o.pcd", "FIELDS ", ' ');
      for (const char* axis : {"x", "y", "z"})
        if (const std::size_t at = names.find(std::string("normal_") + axis); at != names.npos)
          names.replace(at, 8, std::string("n") + axis);
      EXPECT_EQ(names, expected) << keep;
      EXPECT_EQ(tool("verify o.pcd").status, 0) << tool("verify o.pcd").err;
      made(fmt::format("run a.las o.ply -q -f --order {} --keep {} --pipeline normals", order, keep));
      EXPECT_EQ(tool("verify o.ply").status, 0) << tool("verify o.ply").err;
    }
    made(fmt::format("run a.las o.las -q -f --keep {} --pipeline normals", keep));
    EXPECT_EQ(tool("verify o.las").status, 0) << tool("verify o.las").err;
  }
  made("run a.las o.csv -q -f --keep ny,intensity --prefix p_ --pipeline normals");
  EXPECT_EQ(columns("o.csv", "", ','), "x y z p_ny intensity");
  made("sort a.las o.csv -q -f --keep gps_time,z");
  EXPECT_EQ(columns("o.csv", "", ','), "x y z gps_time");
}

}  // namespace
}  // namespace pointsweep
