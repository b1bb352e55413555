// SPDX-License-Identifier: MIT
/// The operator crop with a file of polygons as a user runs it: the record in the output, and runs that are resumed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class CropStage : public Tool {
 protected:
  CropStage() {
    std::string text = "x y z level\n";
    for (int i = 0; i < 900; ++i) text += fmt::format("{} {} {} {}\n", i % 30, i / 30, i * 37 % 101, i % 7);
    write("all.txt", text);
    write("area.geojson",
          R"({"type": "Feature", "geometry": {"type": "Polygon", "coordinates": [[[2,2],[20,2],[2,20],[2,2]]]}})");
  }
};

TEST_F(CropStage, VerifyReadsTheFileThatTheRunReadAndRefusesAnother) {
  for (const char* out : {"out.las", "out.ply", "out.txt"}) {
    made(fmt::format("run all.txt {} -q --pipeline 'crop(polygon=area.geojson)'", out));
    const Result sound = tool(fmt::format("verify {}", out));
    EXPECT_EQ(sound.status, 0) << sound.out << sound.err;
    EXPECT_NE(tool(fmt::format("info {}", out)).out.find("crop(polygon=area.geojson, checksum="), std::string::npos);
  }
  // Rows of 19 points down to 1: all points with x + y <= 22, including points on the edges.
  const std::string text = contents(folder_ / "out.txt");
  EXPECT_EQ(tool("info out.txt").out.find("points      190") != std::string::npos, true) << tool("info out.txt").out;
  write("less.txt", text.substr(0, text.rfind('\n', text.size() - 2) + 1));
  refused(1, "verify all.txt less.txt", "189 points came out of 190");
  write("area.geojson", contents(folder_ / "area.geojson") + "\n");
  refused(1, "verify out.las", "area.geojson: are not the polygons that the run read: their checksum is");
  std::filesystem::remove(folder_ / "area.geojson");
  refused(1, "verify out.las", "area.geojson: cannot be opened");
}

TEST_F(CropStage, AnEmptyResultNamesTheBoxes) {
  const Result result = tool("run all.txt none.ply --pipeline 'crop([700,2,900,8])'");
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.err.find("warning: no point passed; none.ply is empty: crop spans x 700 .. 900, y 2 .. 8"),
            std::string::npos)
      << result.err;
  made("run all.txt all.las --pipeline 'decimate(1)'");
  EXPECT_NE(tool("run all.las none.las --pipeline 'crop([700,2,900,8])'").err.find(", the input x 0 .. 29, y 0 .. 29"),
            std::string::npos);
}

TEST_F(CropStage, AFileThatGisProgramsConvertIsNamedWithTheCommand) {
  write("area.shp", "x");
  refused(1, "run all.txt out.ply --pipeline 'crop(polygon=area.shp)'",
          "area.shp: polygons are read as GeoJSON or WKT; convert the file: ogr2ogr -f GeoJSON polygons.geojson "
          "area.shp");
}

TEST_F(CropStage, TilesAndTheMergedCloudKeepTheSamePoints) {
  std::string a = "x y z\n", b = a;
  for (int i = 0; i < 400; ++i) (i % 3 == 0 ? a : b) += fmt::format("{} {} {}\n", i % 20, i / 20, i % 11);
  std::filesystem::create_directory(folder_ / "tiles");
  write("tiles/a.txt", a), write("tiles/b.txt", b);
  const std::string options = " -f -q --no-provenance --pipeline 'crop(polygon=area.geojson, outside=true) | normals'";
  made("run tiles -o out/" + options);
  std::string rows = made("run tiles/a.txt tiles/b.txt -o all.out.txt" + options, "all.out.txt");
  const std::string first = contents(folder_ / "out/a.txt"), second = contents(folder_ / "out/b.txt");
  EXPECT_EQ(first + second.substr(second.find('\n') + 1), rows);
}

}  // namespace
}  // namespace pointsweep
