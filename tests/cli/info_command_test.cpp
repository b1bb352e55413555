// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "pointsweep/formats/crs.h"
#include "pointsweep/info/point_spacing.h"
#include "tests/cli/tool.h"
#include "tests/formats/las_test_file.h"

namespace pointsweep {
namespace {

class Info : public Tool {
 protected:
  /// Writes a PLY file with `count` points, and returns what `info` prints about it.
  std::string info_of(const std::string& rows, int count) {
    write("a.ply", "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) +
                       "\nproperty float x\nproperty double y\nproperty double z\nproperty uchar red\nend_header\n" +
                       rows);
    const Result result = tool("info a.ply");
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  }
  /// Returns the output of `info --json` for the files.
  nlohmann::ordered_json json_of(const std::string& files, int status = 0) {
    const Result result = tool("info --json " + files);
    EXPECT_EQ(result.status, status) << result.err;
    return nlohmann::ordered_json::parse(result.out);
  }
  static void says(const std::string& text, const std::string& line) {
    EXPECT_NE(("\n" + text).find("\n  " + line + "\n"), std::string::npos) << text << "does not say: " << line;
  }
};

TEST_F(Info, StatesFormatCountBoundsAndAttributes) {
  const std::string text = info_of("1 20 -3 7\n3 5 0.25 8\n2 6 100000.125 9\n", 3);
  says(text, "points      3");
  says(text, "x           1 .. 3");
  says(text, "y           5 .. 20");
  says(text, "z           -3 .. 100000.125");
  says(text, "attributes  x float32, y z float64, red uint8");
  EXPECT_TRUE(text.starts_with("a.ply\n  format      PLY")) << text;
}

TEST_F(Info, QuickReadsHeadersAlone) {
  made("generate statue a.laz -n 3000 -q");
  made("generate terrain b.laz -n 2000 -q");
  std::string damaged = contents(folder_ / "a.laz");
  std::fill(damaged.begin() + std::ssize(damaged) / 2, damaged.begin() + std::ssize(damaged) * 3 / 4, '\xff');
  write("damaged.laz", damaged);
  EXPECT_NE(tool("info damaged.laz").status, 0) << "the test damages points";
  std::string bounds = tool("info a.laz").out, quick = tool("info --quick a.laz").out;
  says(quick, "read        the header alone, which states the bounds");
  bounds.resize(bounds.find("\n  density")), quick.resize(quick.find("\n  attributes"));
  EXPECT_EQ(quick, bounds);
  const auto json = json_of("--quick a.laz b.laz damaged.laz")["files"];
  EXPECT_EQ(json[0]["read"], "header");
  EXPECT_EQ(json[1]["points"], 2000);
  EXPECT_EQ(json[2]["bounds"], json[0]["bounds"]);
  for (const char* unknown : {"nonfinite", "density", "spacing", "ascending", "descending", "classes", "gps_time"})
    EXPECT_TRUE(json[0][unknown].is_null()) << unknown;
  const auto full = json_of("a.laz")["files"][0];
  EXPECT_EQ(full["read"], "points");
  for (const char* known : {"path", "format", "bytes", "points", "crs", "scale", "offset", "provenance"})
    EXPECT_EQ(json[0][known], full[known]) << known;
  std::filesystem::create_directory(folder_ / "t");
  for (const char* name : {"a.laz", "b.laz"}) std::filesystem::rename(folder_ / name, folder_ / "t" / name);
  says(tool("info --quick t").out, "points      5000");
  write("p.csv", "x,y,z\n1,2,3\n4,5,6\n");
  EXPECT_EQ(json_of("--quick p.csv")["files"][0]["points"], 2);
  EXPECT_EQ(tool("info --quick --no-spacing p.csv").status, 2);
}

TEST_F(Info, CheckEndsWithStatus1WhereAFileHasAFault) {
  made("generate statue a.las -n 300 -q");
  EXPECT_EQ(tool("info --check a.las").status, 0) << tool("info --check a.las").err;
  std::string bytes = contents(folder_ / "a.las");
  const double wrong = 999999;
  std::memcpy(bytes.data() + 179, &wrong, sizeof wrong);  // the greatest x
  write("wrong.las", bytes);
  EXPECT_EQ(tool("info wrong.las").status, 0);
  EXPECT_EQ(tool("info --quick --check wrong.las").status, 0) << "only the points contradict the header";
  refused(1, "info --check a.las wrong.las", "1 of 2 files have the faults that the warnings name.");
}

TEST_F(Info, FindsTheOrderAlongEachAxis) {
  says(info_of("1 9 5 0\n1 8 7 0\n2 7 6 0\n", 3), "order       ascending along x, descending along y");
  says(info_of("1 1 5 0\n2 2 4 0\n3 3 5 0\n", 3), "order       ascending along x and y");
  says(info_of("1 2 1 0\n2 1 2 0\n1 2 1 0\n", 3), "order       not ascending along x, y or z");
  says(info_of("5 5 1 0\n5 5 2 0\n", 2), "order       ascending along z");
}

TEST_F(Info, CountsPointsThatAreNotFiniteAndKeepsThemOutOfTheBounds) {
  const std::string text = info_of("1 1 1 0\nnan 9 9 0\n2 2 2 0\n3 inf 0 0\n", 4);
  says(text, "points      4");
  says(text, "not finite  2 points, not in the bounds");
  says(text, "y           1 .. 2");
  says(text, "order       ascending along x and y and z");
}

TEST_F(Info, AddsUpSeveralFiles) {
  write("a.xyz", "0 0 0\n1 1 1\n");
  write("b.xyz", "5 -1 0\n");
  const Result result = tool("info a.xyz b.xyz");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("all 2 files\n  points      3\n  x           0 .. 5\n  y           -1 .. 1\n"),
            std::string::npos)
      << result.out;
}

TEST_F(Info, KnowsASortedFileFromAGeneratedOne) {
  ASSERT_EQ(tool("generate statue a.ply -n 5000").status, 0);
  says(tool("info a.ply").out, "order       not ascending along x, y or z");
  ASSERT_EQ(tool("sort a.ply b.ply --axis y").status, 0);
  says(tool("info b.ply").out, "order       ascending along y");
}

TEST_F(Info, GivesTheRangeOfEveryAttribute) {
  const std::string text = info_of("1 20 -3 7\n3 5 0.25 8\n2 6 100000.125 9\n", 3);
  says(text, "  red  7 .. 9");
}

TEST_F(Info, DensityAndSpacingOfAGridAreThoseOfTheGrid) {
  // 100 × 100 points, 0.25 apart, over 25 × 25 units: 16 points per square unit, up to the edges of the cells at the
  // border.
  std::string rows;
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j) rows += fmt::format("{} {} 0 0\n", 0.25 * i, 0.25 * j);
  info_of(rows, 10000);
  const auto json = json_of("a.ply").at("files").at(0);
  EXPECT_DOUBLE_EQ(json.at("spacing"), 0.25);
  EXPECT_EQ(json.at("spacing_sample"), 1000);
  EXPECT_EQ(json.at("spacing_duplicates"), 0);
  EXPECT_NEAR(json.at("density"), 16, 1.5);
}

TEST_F(Info, CountsDuplicatesInTheSample) {
  const auto json = [this] {
    info_of("1 1 1 0\n1 1 1 0\n5 5 5 0\n", 3);
    return json_of("a.ply").at("files").at(0);
  }();
  EXPECT_EQ(json.at("spacing"), 0);
  EXPECT_EQ(json.at("spacing_duplicates"), 2);
}

TEST_F(Info, APointAloneHasNoSpacing) {
  info_of("1 1 1 0\n", 1);
  EXPECT_TRUE(json_of("a.ply").at("files").at(0).at("spacing").is_null());
  info_of("nan 1 1 0\n", 1);
  const auto json = json_of("a.ply").at("files").at(0);
  EXPECT_TRUE(json.at("bounds").is_null());
  EXPECT_TRUE(json.at("density").is_null());
  EXPECT_EQ(json.at("nonfinite"), 1);
}

TEST_F(Info, SpacingCanBeLeftOut) {
  ASSERT_EQ(tool("generate plane a.ply -n 1000").status, 0);
  const Result result = tool("info a.ply --no-spacing");
  EXPECT_EQ(result.out.find("spacing"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("density"), std::string::npos) << result.out;
}

TEST_F(Info, TellsTheClassesReturnsScaleAndTimesOfALasFile) {
  las_test::File file;
  file.format = 1;
  file.count = 3;
  file.scale = {0.01, 0.001, 0.25};
  file.offset = {100, 200, 0};
  std::string bytes = file.bytes();
  const auto set = [&](std::size_t point, int number, int of, int code, double time) {
    const std::size_t at = file.points_at() + point * file.record_length();
    las_test::put(bytes, at + 14, static_cast<std::uint8_t>(number | of << 3));
    las_test::put(bytes, at + 15, static_cast<std::uint8_t>(code));
    las_test::put(bytes, at + 20, time);
  };
  set(0, 1, 2, 2, 300.5);
  set(1, 2, 2, 5, 300.25);
  set(2, 1, 1, 2, 400);
  las_test::put(bytes, 6, std::uint16_t{0});
  write("a.las", bytes);
  const std::string text = tool("info a.las").out;
  says(text, "scale       0.01 0.001 0.25");
  says(text, "offset      100 200 0");
  says(text, "classes     2 Ground: 2, 5 High vegetation: 1");
  says(text, "returns     1: 2, 2: 1");
  says(text, "gps time    300.25 .. 400 (seconds of the GPS week)");
  las_test::put(bytes, 6, std::uint16_t{1});
  write("b.las", bytes);
  says(tool("info b.las").out,
       "gps time    300.25 .. 400 (adjusted standard: 2011-09-14T01:51:40 .. 2011-09-14T01:53:20)");
  ASSERT_EQ(tool("sort b.las once_las.ply --axis x").status, 0);
  says(tool("info once_las.ply").out,
       "gps time    300.25 .. 400 (adjusted standard: 2011-09-14T01:51:40 .. 2011-09-14T01:53:20)");
  const auto json = json_of("b.las").at("files").at(0);
  EXPECT_EQ(json.at("classes").dump(), R"({"2":2,"5":1})");
  EXPECT_EQ(json.at("returns").dump(), R"({"1":2,"2":1})");
  EXPECT_EQ(json.at("gps_time").at("clock"), "adjusted_standard");
  EXPECT_EQ(json.at("scale").dump(), "[0.01,0.001,0.25]");
}

TEST_F(Info, NamesTheCoordinateReferenceSystem) {
  las_test::File file;
  std::string keys(8 * 4, '\0');  // directory: version 1.1.0 with 3 keys: projected, EPSG 26910, metres
  const auto put_key = [&](std::size_t i, std::uint16_t key, std::uint16_t count, std::uint16_t value) {
    las_test::put(keys, 8 * i, key);
    las_test::put(keys, 8 * i + 4, count);
    las_test::put(keys, 8 * i + 6, value);
  };
  put_key(0, 1, 0, 3);
  las_test::put(keys, 2, std::uint16_t{1});
  put_key(1, 1024, 1, 1);
  put_key(2, 3072, 1, 26910);
  put_key(3, 3076, 1, 9001);
  file.vlrs = {las_test::vlr("LASF_Projection", 34735, keys)};
  std::string bytes = file.bytes();
  las_test::put(bytes, 6, std::uint16_t{0});
  write("a.las", bytes);
  EXPECT_NE(tool("info a.las").out.find("  crs         EPSG:26910"), std::string::npos) << tool("info a.las").out;
  const auto crs = json_of("a.las").at("files").at(0).at("crs");
  EXPECT_EQ(crs.at("epsg"), 26910);
  EXPECT_EQ(crs.at("length_unit"), "m");
  EXPECT_TRUE(crs.at("vertical_epsg").is_null());
  file.vlrs.clear();
  write("b.las", file.bytes());
  EXPECT_TRUE(json_of("b.las").at("files").at(0).at("crs").is_null());
}

TEST(LengthUnit, IsThatOfTheHorizontalSystem) {
  const auto unit = [](const char* wkt) { return length_unit_of(crs_of_wkt(wkt)); };
  EXPECT_EQ(unit(R"(PROJCS["a",GEOGCS["b",UNIT["degree",0.0174532925199433]],UNIT["metre",1]])"), "m");
  EXPECT_EQ(unit(R"(PROJCS["a",GEOGCS["b",UNIT["degree",0.0174532925199433]],UNIT["foot",0.3048]])"), "ft");
  EXPECT_EQ(unit(R"(PROJCS["a",GEOGCS["b"],UNIT["US survey foot",0.304800609601219]])"), "US survey ft");
  EXPECT_EQ(unit(R"(COMPD_CS["c",PROJCS["a",GEOGCS["b"],UNIT["foot",0.3048]],VERT_CS["v",UNIT["metre",1]]])"), "ft");
  EXPECT_EQ(unit(R"(PROJCRS["a",BASEGEOGCRS["b",ELLIPSOID["e",6378137,298.2,LENGTHUNIT["metre",1]]],CS[Cartesian,2],)"
                 R"(AXIS["x",east],ANGLEUNIT["degree",0.0174],LENGTHUNIT["US survey foot",0.304800609601219]])"),
            "US survey ft");
  EXPECT_EQ(
      unit(
          R"(COMPD_CS["c",PROJCS["a",GEOGCS["b"],UNIT["f",0.3048006096012192]],VERTCS["v",UNIT["US survey foot",1.0]]])"),
      "US survey ft");
  EXPECT_EQ(unit(R"(GEOGCS["b",UNIT["degree",0.0174532925199433]])"), "");
  EXPECT_EQ(unit(R"(PROJCS["a",GEOGCS["b"],UNIT["f",0.3048]],VERTCS["v",UNIT["Meter",1.0]])"), "ft");
  EXPECT_EQ(unit(R"(Projcs ("a", Geogcs("b", Unit("degree", 0.0174532925199433)), Unit ("foot", 0.3048)))"), "ft");
  EXPECT_EQ(unit(R"(COMPOUNDCRS["c",PROJCRS["a",BASEGEOGCRS["b"],CS[Cartesian,2],LENGTHUNIT["foot",0.3048]],)"
                 R"(VERTICALCRS["v",CS[vertical,1],LENGTHUNIT["metre",1]]])"),
            "ft");
  EXPECT_EQ(unit(R"(BOUNDCRS[SOURCECRS[PROJCRS["a",BASEGEOGCRS["b"],CS[Cartesian,2],LENGTHUNIT["foot",0.3048]]],)"
                 R"(TARGETCRS[GEOGCRS["w"]],ABRIDGEDTRANSFORMATION["t",PARAMETER["dx",1,LENGTHUNIT["metre",1]]]])"),
            "ft");
  EXPECT_EQ(unit(R"(PROJCRS["a",BASEGEOGCRS["b"],CS[Cartesian,2],SCALEUNIT["unity",1]])"), "");
  EXPECT_EQ(unit("PROJCS[\"a\",UNIT[\"met"), "");
}

TEST_F(Info, JsonHasTheDocumentedKeys) {
  ASSERT_EQ(tool("generate statue a.ply -n 500").status, 0);
  const auto json = json_of("a.ply nothing.ply", 1);
  std::string keys;
  for (const auto& [key, value] : json.at("files").at(0).items()) keys += key + " ";
  EXPECT_EQ(
      keys,
      "path format bytes points read nonfinite bounds crs scale offset density density_cell spacing spacing_sample "
      "spacing_duplicates ascending descending classes returns gps_time attributes provenance warnings ");
  EXPECT_EQ(json.at("files").at(1).at("path"), "nothing.ply");
  EXPECT_NE(json.at("files").at(1).at("error").get<std::string>().find("no such file"), std::string::npos);
  EXPECT_EQ(json.at("all").at("unreadable"), 1);
  EXPECT_EQ(json.at("all").at("points"), 500);
  EXPECT_EQ(json.at("files").at(0).at("attributes").at(3).at("name"), "nx");
  EXPECT_TRUE(json.at("files").at(0).at("classes").is_null());
}

TEST_F(Info, GoesOnAfterAFileThatCannotBeReadAndEndsWithStatus1) {
  write("a.xyz", "0 0 0\n1 1 1\n");
  write("noise.ply", "this is prose, not points");
  const Result result = tool("info noise.ply missing.las a.xyz");
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.out.find("a.xyz\n"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("1 of 3 files\n  points      2\n"), std::string::npos) << result.out;
  for (const char* words : {"noise.ply", "missing.las", "2 of 3 files could not be read"})
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
  EXPECT_NE(tool("info -q noise.ply a.xyz").err.find("noise.ply"), std::string::npos) << "quiet is not silent";
}

/// A folder of files that differ in all respects.
class InfoTable : public Info {
 protected:
  InfoTable() {
    std::filesystem::create_directory(folder_ / "tiles");
    las("a.las", 0, wkt(2056), 1);
    las("b.las", 0, wkt(2056), 2);
  }
  static std::string wkt(int epsg) {
    return fmt::format(
        "PROJCS[\"grid {0}\",GEOGCS[\"g\",DATUM[\"d\",SPHEROID[\"s\",6378137,298]]],AUTHORITY[\"EPSG\","
        "\"{0}\"]]",
        epsg);
  }
  void las(const std::string& name, int global_encoding, const std::string& crs, unsigned seed) {
    las_test::File file;
    file.minor = 4;
    file.format = 6;
    file.count = 50;
    file.seed = seed;
    file.scale = {0.001, 0.001, 0.001};
    if (!crs.empty()) file.vlrs = {las_test::vlr("LASF_Projection", 2112, crs)};
    std::string bytes = file.bytes();
    las_test::put(bytes, 6, static_cast<std::uint16_t>(global_encoding | 16));
    write("tiles/" + name, bytes);
  }
  void says_line(const std::string& text, const std::string& words) {
    EXPECT_NE(text.find("\n    " + words), std::string::npos) << text << "does not say: " << words;
  }
};

TEST_F(InfoTable, HasALineForEachFileOfAFolderAndSaysThatTheyAgree) {
  const Result run = tool("info tiles");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_TRUE(run.out.starts_with("file   points  x")) << run.out;
  EXPECT_NE(run.out.find("\na.las      50  "), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("  EPSG:2056  (1)\nb.las      50  "), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("\nattributes (1)  x y z int32, intensity uint16"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("\nall 2 files\n  points      100\n"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("\n  The files are consistent.\n"), std::string::npos) << run.out;
  EXPECT_EQ(tool("info 'tiles/*.las'").out, run.out);
  const std::string named = tool("info --table tiles/a.las tiles/b.las").out;
  EXPECT_NE(named.find("\ntiles/a.las      50  "), std::string::npos) << named;
  EXPECT_EQ(json_of("tiles").at("files").at(0).at("path"), "tiles/a.las");
  EXPECT_NE(tool("info tiles/a.las tiles/b.las").out.find("\n  format "), std::string::npos) << "in full";
}

TEST_F(InfoTable, BoundsAreRoundedToTheExtentAndDensityIsThatOfTheFile) {
  write("tiles/g.xyz", "500000.1234 10 3\n500010.9876 20 3\n");
  const std::string text = tool("info tiles/g.xyz --table").out;
  EXPECT_NE(text.find("  500000.123 .. 500010.988  10.000 .. 20.000  3  "), std::string::npos) << text;
}

TEST_F(InfoTable, SaysInWhatTheFilesDiffer) {
  las("c.las", 1, wkt(32632), 3);
  las("d.las", 0, "", 4);
  std::filesystem::copy(folder_ / "tiles/a.las", folder_ / "tiles/e.las");
  write("tiles/f.xyz", "x y z intensity weight\n1 2 3 4 5\nnan 2 3 4 5\n");
  write("tiles/g.ply",
        "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
        "property float z\nend_header\n");
  const Result run = tool("info tiles");
  ASSERT_EQ(run.status, 0) << run.err;
  says_line(run.out, "Formats differ: LAS 1.4 point format 6 in a.las and 4 more; text, ");
  says_line(run.out,
            "Coordinate reference systems differ: EPSG:2056 (grid 2056) in a.las and 2 more; EPSG:32632 (grid "
            "32632) in c.las.");
  says_line(run.out, "No coordinate reference system is stated in d.las and 2 more.");
  says_line(run.out,
            "Clocks of GPS times differ: seconds of the GPS week in a.las and 3 more; adjusted standard GPS time "
            "in c.las.");
  says_line(run.out, "Attribute intensity is missing in g.ply.");
  says_line(run.out, "Attribute weight is missing in a.las and 5 more.");
  says_line(run.out, "Attributes return_number, number_of_returns, ");
  says_line(run.out,
            "Types of x, y and z differ: int32 (scale 0.001) in a.las and 4 more; float64 in f.xyz; float32 "
            "in g.ply.");
  says_line(run.out, "Types of intensity differ: uint16 in a.las and 4 more; float64 in f.xyz.");
  says_line(run.out, "No points are in g.ply.");
  says_line(run.out, "1 point has coordinates that are not finite, in f.xyz.");
  says_line(run.out, "a.las and 1 more have the same bounds and number of points: copies of one file?");
  const auto json = json_of("tiles").at("all");
  EXPECT_EQ(json.at("inconsistent").size(), 12u) << json.dump(1);
  EXPECT_GT(json.at("density").get<double>(), 0);
}

TEST_F(InfoTable, NamesThatMeanTheSameAreOneAttribute) {
  write("tiles/a.las", "");
  std::filesystem::remove(folder_ / "tiles/a.las");
  std::filesystem::remove(folder_ / "tiles/b.las");
  write("tiles/a.xyz", "x y z nx ny nz\n1 2 3 1 0 0\n");
  write("tiles/b.xyz", "X Y Z NormalX NormalY NormalZ\n2 2 3 1 0 0\n");
  const std::string text = tool("info tiles").out;
  EXPECT_NE(text.find("The files are consistent."), std::string::npos) << text;
}

TEST_F(InfoTable, HasALineForFilesThatCannotBeReadAndEndsWithStatus1) {
  write("tiles/broken.las", "no LAS at all");
  const Result run = tool("info tiles");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.out.find("\nbroken.las  cannot be read\n"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("\n2 of 3 files\n"), std::string::npos) << run.out;
  EXPECT_NE(run.err.find("1 of 3 files could not be read."), std::string::npos) << run.err;
  refused(2, "info --json --table tiles", "--table");
}

/// Compares files of the library's own writers, whose headers are right, with copies whose headers are changed.
TEST_F(Info, ComparesTheHeaderOfLasWithThePoints) {
  for (const char* name : {"a.las", "a.laz"}) {
    std::string bytes = made(fmt::format("generate terrain {} -n 2000", name), name);
    EXPECT_EQ(json_of(name).at("files").at(0).at("warnings").size(), 0u) << name;
    las_test::put(bytes, 179, 999999.0);  // greatest x
    const bool is_new = bytes[25] == 4;
    is_new ? las_test::put(bytes, 255, std::uint64_t{5}) : las_test::put(bytes, 111, std::uint32_t{5});
    write(name, bytes);
    const Result result = tool(fmt::format("info {}", name));
    EXPECT_EQ(result.status, 0);
    EXPECT_NE(result.err.find(": the header states x from "), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(" to 999999; the points have "), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(": the header counts points by return as 1: 5; there are 1: 2000."), std::string::npos)
        << result.err;
    EXPECT_EQ(result.err.find("states y"), std::string::npos) << result.err;
    EXPECT_EQ(json_of(name).at("files").at(0).at("warnings").size(), 2u);
  }
}

TEST_F(Info, CountsReturnNumbersAboveTheNumberOfReturns) {
  write("a.txt", "x y z ReturnNumber NumberOfReturns\n1 2 3 1 1\n2 3 4 2 1\n3 4 5 2 2\n");
  EXPECT_NE(tool("info a.txt").err.find("1 point has a return number above the number of returns."), std::string::npos);
}

TEST(PlanArea, TheResultDoesNotDependOnTheOrderOfPoints) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> in(-3e5, 5e6);
  std::vector<std::pair<double, double>> points;
  for (int i = 0; i < 20000; ++i) points.emplace_back(in(random), 1e-3 * in(random));
  PlanArea there(points.size()), back(points.size());
  for (const auto& [x, y] : points) there.add(x, y);
  for (auto p = points.rbegin(); p != points.rend(); ++p) back.add(p->first, p->second);
  there.settle(), back.settle();
  EXPECT_EQ(there.area(), back.area());
  EXPECT_EQ(there.cell_side(), back.cell_side());
  EXPECT_GT(there.area(), 0.8 * 5.3e6 * 5.3e3);
}

TEST(PlanArea, AnyCoordinatesHaveAnArea) {
  for (const double far : {1e-3, 1.0, 1e18, 1e150}) {
    PlanArea plan(1000);
    for (int i = 0; i < 1000; ++i) plan.add(far * (i % 32) / 32, -far * (i / 32) / 32);
    plan.settle();
    EXPECT_GT(plan.area(), 0.5 * far * far) << far;
    EXPECT_LT(plan.area(), 5 * far * far) << far;
  }
}

TEST(PlanArea, AFewPlacesCoverNoArea) {
  EXPECT_EQ(PlanArea(100).area(), 0);
  PlanArea plan(6);
  for (const double x : {0.0, 1.0, 0.0}) plan.add(x, 1 - x), plan.add(x, 1 - x);
  plan.settle();
  EXPECT_EQ(plan.area(), 0) << "a density of their cells would be that of the smallest cell there is";
  PlanArea far(1);
  far.add(5e6, -4e7);
  far.settle();
  EXPECT_EQ(far.area(), 0);
}

using Places = std::vector<std::pair<double, double>>;

/// Returns clouds that are evenly spread, in clusters, in clusters with a few points far from them, and along a line.
std::vector<Places> some_clouds() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> even(0, 100);
  std::normal_distribution<double> near(0, 0.5);
  std::vector<Places> clouds(4);
  for (int i = 0; i < 20000; ++i) {
    const double center = 10 * (i % 7) + 20;
    clouds[0].emplace_back(even(random), even(random));
    clouds[1].emplace_back(center + near(random), 1.2 * center + near(random));
    clouds[2].push_back(i % 50 == 0 ? std::pair(even(random), even(random)) : clouds[1].back());
    clouds[3].emplace_back(0.005 * i, 0.005 * i + near(random));
  }
  return clouds;
}

PlanArea area_of(const Places& places) {
  PlanArea plan(places.size());
  for (const auto& [x, y] : places) plan.add(x, y);
  plan.settle();
  return plan;
}

double density_of(const Places& places) { return static_cast<double>(places.size()) / area_of(places).area(); }

/// Returns the places of a cloud without most of the places that `goes` chooses. Places at the bounds of the cloud
/// stay.
Places without(const Places& all, const std::function<bool(const std::pair<double, double>&)>& goes) {
  const auto by_y = [](const auto& a, const auto& b) { return a.second < b.second; };
  const auto [least, most] = std::minmax_element(all.begin(), all.end());
  const auto [low, high] = std::minmax_element(all.begin(), all.end(), by_y);
  Places left = {*least, *most, *low, *high};
  for (const auto& p : all)
    if (!goes(p)) left.push_back(p);
  return left;
}

TEST(PlanArea, FewerPointsWithinTheSameBoundsNeverGetSmallerCells) {
  for (const Places& all : some_clouds())
    for (double share = 0.99; share > 0.01; share *= 0.7) {
      std::mt19937 random(9);
      std::uniform_real_distribution<double> uniform(0, 1);
      const Places left = without(all, [&](const auto&) { return uniform(random) > share; });
      EXPECT_GE(area_of(left).cell_side(), area_of(all).cell_side()) << share;
      EXPECT_LE(density_of(left), density_of(all)) << "points chosen at random, a share of " << share;
    }
}

TEST(PlanArea, WithoutThePointsThatLieApartCellsAreNotSmaller) {
  const Places all = some_clouds()[2];
  const Places left = without(all, [](const auto& p) { return std::abs(p.second - 1.2 * p.first) > 3; });
  ASSERT_GT(left.size(), 0.98 * static_cast<double>(all.size()));
  EXPECT_GE(area_of(left).cell_side(), area_of(all).cell_side());
}

TEST(PlanArea, DensityNeverRisesWhereEveryOccupiedCellKeepsAPoint) {
  for (const Places& all : some_clouds()) {
    const double side = area_of(all).cell_side();
    for (const std::size_t each : {1, 2, 5, 20}) {
      std::map<std::pair<double, double>, std::size_t> kept;
      const auto cell_of = [&](const auto& p) {
        return std::pair(std::floor(p.first / side), std::floor(p.second / side));
      };
      const Places left = without(all, [&](const auto& p) { return kept[cell_of(p)]++ >= each; });
      EXPECT_LE(density_of(left), density_of(all)) << each;
    }
  }
}

TEST(NearestDistances, AreThoseOfBruteForce) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> in(0, 1);
  std::vector<Vec3> cloud;
  for (int i = 0; i < 3000; ++i) cloud.push_back({in(random), in(random), i % 3 == 0 ? 0 : in(random)});
  for (int i = 0; i < 50; ++i) cloud.push_back(cloud[static_cast<std::size_t>(7 * i)]);
  std::vector<NearestDistances::Sampled> sample;
  for (std::uint64_t row = 0; row < cloud.size(); row += 11) sample.push_back({cloud[row], row});
  NearestDistances nearest(sample);
  for (std::size_t row = 0; row < cloud.size(); ++row) nearest.add(cloud[row], row);
  std::vector<double> expected;
  for (const auto& s : sample) {
    double least = INFINITY;
    for (std::size_t row = 0; row < cloud.size(); ++row)
      if (row != s.row) least = std::min(least, length(cloud[row] - s.position));
    expected.push_back(least);
  }
  std::sort(expected.begin(), expected.end());
  const std::vector<double> found = nearest.distances();
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_DOUBLE_EQ(found[i], expected[i]);
}

TEST_F(Info, ReportsProgressToPrograms) {
  ASSERT_EQ(tool("generate plane a.ply -n 1000").status, 0);
  EXPECT_EQ(tool("info a.ply --progress-fd 5 5>progress").status, 0);
  EXPECT_NE(contents(folder_ / "progress").find(R"({"phase":"info","done":2000,"total":2000,)"), std::string::npos);
}

TEST_F(Info, RefusesWhatIsMissingOrNoCloud) {
  refused(2, "info", "FILE");
  refused(1, "info nothing.ply", "nothing.ply");
  write("noise.ply", "this is prose, not points");
  refused(1, "info noise.ply", "noise.ply");
}

}  // namespace
}  // namespace pointsweep
