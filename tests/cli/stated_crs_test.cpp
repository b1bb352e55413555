// SPDX-License-Identifier: MIT
/// --crs and --replace-crs: outputs state the coordinate reference system that the user names, and no coordinate
/// changes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "pointsweep/formats/crs.h"
#include "tests/cli/tool.h"
#include "tests/formats/point_files.h"

namespace pointsweep {
namespace {

constexpr const char* kCopyInto = " -q -f --pipeline 'decimate(1)' ";
constexpr const char* kWkt =
    "PROJCS[\"RGF93 / Lambert-93\",GEOGCS[\"RGF93\",DATUM[\"RGF\",SPHEROID[\"GRS 1980\",6378137,298.257222101]],"
    "PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Lambert_Conformal_Conic_2SP\"],"
    "UNIT[\"metre\",1],AUTHORITY[\"EPSG\",\"2154\"]]";

class StatedSystem : public Tool {
 protected:
  StatedSystem() {
    std::string text = "x y z gps_time\n";
    for (int i = 0; i < 200; ++i)
      text += fmt::format("{:.2f} {:.2f} {:.2f} {}\n", 650000 + i * 79 % 101 / 4.0, 6860000 + i * 53 % 97 / 4.0,
                          i % 7 / 2.0, i);
    write("a.xyz", text);
    write("l93.prj", kWkt);
    write("marked.prj", fmt::format("\xEF\xBB\xBF{}", kWkt));
  }
  std::optional<Crs> system(const std::string& file) const { return open_reader(folder_ / file)->info().crs; }
  std::string format(const std::string& file) const { return open_reader(folder_ / file)->info().format; }
  std::vector<double> values(const std::string& file, const std::string& field) const {
    return values_of(*open_reader(folder_ / file), field);
  }
  void run(const std::string& in, const std::string& out, const std::string& options) {
    made(fmt::format("run {} {} {}{}", in, out, options, kCopyInto));
  }
  void expect_code(const std::string& file, int code, bool has_wkt) const {
    const auto crs = system(file);
    ASSERT_TRUE(crs.has_value()) << file;
    EXPECT_EQ(crs->epsg, code) << file;
    EXPECT_EQ(!crs->wkt.empty(), has_wkt) << file;
  }
};

TEST_F(StatedSystem, ACodeBecomesGeoTiffKeysAndAFileItsWkt) {
  for (const char* out : {"o.las", "o.laz", "o.ply"}) {
    run("a.xyz", out, "--crs EPSG:2154");
    expect_code(out, 2154, false);
    EXPECT_EQ(system(out)->kind, CrsKind::projected);
    run("a.xyz", out, "--crs EPSG:2154+5720");
    EXPECT_EQ(system(out)->vertical_epsg, 5720);
    for (const char* file : {"l93.prj", "marked.prj"}) {
      run("a.xyz", out, fmt::format("--crs {}", file));
      expect_code(out, 2154, true);
    }
    run("a.xyz", out, "--crs EPSG:4326");
    EXPECT_EQ(system(out)->kind, CrsKind::geographic);
    EXPECT_EQ(values(out, "x"), values("a.xyz", "x"));
  }
  const Result modern = tool("run a.xyz o.las -f --crs EPSG:2154 --pipeline 'decimate(1)'");
  EXPECT_NE(modern.err.find("asks for the coordinate reference system as WKT, but only GeoTIFF keys are known"),
            std::string::npos)
      << modern.err;
  const Result legacy = tool("run a.xyz o.las -f --crs EPSG:2154 --las-version 1.2 --pipeline 'decimate(1)'");
  EXPECT_EQ(legacy.err.find("warning"), std::string::npos) << legacy.err;
  EXPECT_NE(format("o.las").find("LAS 1.2"), std::string::npos);
  run("a.xyz", "o.las", "--crs l93.prj --las-version 1.2");
  write("local.prj", R"(LOCAL_CS["site grid",UNIT["metre",1]])");
  const std::string local = "run a.xyz local.las -f --crs local.prj --pipeline 'decimate(1)' --las-version 1.";
  EXPECT_NE(tool(local + "2").err.find("LAS 1.2 names a coordinate reference system by GeoTIFF keys"),
            std::string::npos);
  EXPECT_EQ(tool(local + "4").err.find("by GeoTIFF keys"), std::string::npos);
  expect_code("o.las", 2154, true);
  made("generate statue s.las -n 100 -q --crs EPSG:2154");
  expect_code("s.las", 2154, false);
  made("sort a.xyz s.ply -q --crs l93.prj");
  expect_code("s.ply", 2154, true);
}

TEST_F(StatedSystem, AnotherSystemOfAFileIsReplacedOnlyByConsent) {
  for (const char* in : {"a.las", "a.laz", "a.ply"})
    for (const char* how : {"--crs l93.prj", "--crs EPSG:2154"}) {
      run("a.xyz", in, how);
      const auto own = system(in);
      refused(2, fmt::format("run {} o.las --crs EPSG:25832{}", in, kCopyInto),
              fmt::format("--crs: EPSG:25832 is given, and {} states EPSG:2154", in));
      for (const char* out : {"o.las", "o.laz", "o.ply"}) {
        run(in, out, "--crs EPSG:2154");
        EXPECT_EQ(system(out)->wkt, own->wkt) << "the file's own statement says more than the code";
        run(in, out, "--crs EPSG:25832 --replace-crs");
        expect_code(out, 25832, false);
        run(in, out, "--crs none");
        EXPECT_FALSE(system(out).has_value()) << in << out;
        EXPECT_EQ(values(out, "y"), values("a.xyz", "y"));
        EXPECT_EQ(tool(fmt::format("verify {}", out)).status, 0) << tool(fmt::format("verify {}", out)).err;
      }
    }
  run("a.xyz", "b.las", "--crs EPSG:25832");
  refused(2, std::string("run a.las b.las -o c.las") + kCopyInto, "transform one of them first");
  run("a.las b.las", "-o c.las", "--crs EPSG:2154 --replace-crs");
  expect_code("c.las", 2154, false);
}

TEST_F(StatedSystem, EveryTileAndAResumedRunStatesIt) {
  std::filesystem::create_directory(folder_ / "tiles");
  run("a.xyz", "tiles/a.las", "--crs EPSG:25832");
  run("a.xyz", "tiles/b.laz", "");
  made("normals tiles/ out/ -q --crs EPSG:2154 --replace-crs");
  expect_code("out/a.las", 2154, false);
  expect_code("out/b.laz", 2154, false);
  EXPECT_EQ(tool("verify tiles/ out/").status, 0) << tool("verify tiles/ out/").err;
  const std::string plain = made("normals tiles/a.las o.las -q --crs l93.prj --replace-crs", "o.las");
  EXPECT_EQ(made("normals tiles/a.las o.las -q -f --crs l93.prj --replace-crs --resume kept", "o.las"), plain);
  made("normals a.xyz n.ply -q --crs EPSG:2154 --dry-run");
  made("run a.xyz none.las -q --crs EPSG:2154 --pipeline 'where(x < 0)'");
  expect_code("none.las", 2154, false);
}

TEST_F(StatedSystem, CountsForLengthsAndDegrees) {
  refused(2, "normals a.xyz o.ply --crs EPSG:4326", "The coordinates are degrees of EPSG:4326");
  run("a.xyz", "deg.las", "--crs EPSG:4326");
  refused(2, "normals deg.las o.ply", "degrees");
  made("normals deg.las o.ply -q --crs EPSG:2154 --replace-crs");
  expect_code("o.ply", 2154, false);
  EXPECT_EQ(tool("verify o.ply").status, 0) << tool("verify o.ply").err;
  run("a.xyz", "m.las", "--crs EPSG:2154");
  const std::string scaled = "run m.las o.las -f --pipeline 'set(x = x + 1)'";
  EXPECT_NE(tool(scaled).err.find("state it with --crs and --replace-crs"), std::string::npos);
  EXPECT_EQ(tool(scaled + " --crs EPSG:2154").err.find("state it with"), std::string::npos);
}

TEST_F(StatedSystem, WhatIsNoSystemIsRefused) {
  write("no.prj", "hello");
  for (const char* wrong :
       {"EPSG:", "EPSG:x", "EPSG:1", "EPSG:99999", "EPSG:5698", "EPSG:4978", "EPSG:2154+", "EPSG:2154+99999"})
    refused(2, fmt::format("run a.xyz o.las --crs {}{}", wrong, kCopyInto),
            "is not the code of a projected or geographic");
  for (const char* wrong : {"lambert", "no.prj", "absent.prj"})
    refused(2, fmt::format("run a.xyz o.las --crs {}{}", wrong, kCopyInto),
            "is neither EPSG:CODE, nor a file with WKT");
  refused(2, std::string("run a.xyz o.las --replace-crs") + kCopyInto, "--replace-crs: belongs to --crs");
}

TEST_F(StatedSystem, KindsOfCodesAreThoseOfTheRegistry) {
  for (const int code : {2154, 25832, 26910, 27700, 3857, 4399, 4547, 32760})
    EXPECT_EQ(kind_of_epsg(code), CrsKind::projected) << code;
  for (const int code : {4326, 4269, 4979, 4258, 3819, 4171, 7844})
    EXPECT_EQ(kind_of_epsg(code), CrsKind::geographic) << code;
  for (const int code : {0, -5, 5720, 5698, 4978, 32767, 100000})
    EXPECT_EQ(kind_of_epsg(code), CrsKind::unknown) << code;
}

}  // namespace
}  // namespace pointsweep
