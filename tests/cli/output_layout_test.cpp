// SPDX-License-Identifier: MIT
/// The values that the formats store: decimals of text, types of coordinates, depth of colours, and errors that name
/// rows.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "pointsweep/formats/las_scale.h"
#include "tests/cli/tool.h"
#include "tests/formats/point_files.h"

namespace pointsweep {
namespace {

class Layout : public Tool {
 protected:
  std::vector<double> values(const std::string& file, const std::string& field) const {
    const auto reader = open_reader(folder_ / file);
    return values_of(*reader, field);
  }
  const Field field(const std::string& file, const std::string& name) const {
    const auto reader = open_reader(folder_ / file);
    const auto at = reader->info().schema.find(name);
    EXPECT_TRUE(at.has_value()) << file << " " << name;
    return reader->info().schema.fields[at.value_or(0)];
  }
  std::string format(const std::string& file) const { return open_reader(folder_ / file)->info().format; }
};

TEST_F(Layout, TextBecomesLasWithItsDecimalsAndTheSameTextAgain) {
  std::string text = "x,y,z,intensity\n";
  for (int i = 0; i < 300; ++i)
    text += fmt::format("{},{},{},{}\n", (68499200 + i * 57) / 100.0, (487341100 + i * 31) / 100.0, i % 17 / 100.0 + 11,
                        i * 13 % 1000);
  write("a.csv", text);
  EXPECT_NE(text.find("684992.57,"), std::string::npos);
  for (const char* las : {"a.las", "a.laz"}) {
    made(fmt::format("run a.csv {} -q --pipeline 'decimate(1)'", las));
    EXPECT_EQ(open_reader(folder_ / las)->info().las->grid.scale, (Vec3{0.01, 0.01, 0.01}));
    made(fmt::format("run {} b.csv -q -f --keep x,y,z,intensity --pipeline 'decimate(1)'", las));
    EXPECT_EQ(contents(folder_ / "b.csv"), text);
    EXPECT_NE(tool(fmt::format("info {}", las)).out.find("x           684992 .. 685162.43"), std::string::npos)
        << tool(fmt::format("info {}", las)).out;
    made(fmt::format("run {} all.csv -q -f --pipeline 'decimate(1)'", las));
    EXPECT_EQ(tool(fmt::format("verify {} all.csv", las)).status, 0);
  }
}

TEST_F(Layout, TextOfAGridThatIsNoPowerOfTenKeepsItsScale) {
  std::string text = "x,y,z\n";
  for (int i = 0; i < 300; ++i)
    text += fmt::format("{},{},{}\n", (27396800 + i * 57) / 4000.0, (i * 31 - 5000) / 4000.0, i % 17);
  write("a.csv", text);
  ASSERT_NE(text.find("6849.21425,"), std::string::npos);
  made("run a.csv a.laz -q --pipeline 'decimate(1)'");
  EXPECT_EQ(open_reader(folder_ / "a.laz")->info().las->grid.scale, (Vec3{0.00025, 0.00025, 0.00025}));
  made("run a.laz b.csv -q --keep x,y,z --pipeline 'decimate(1)'");
  EXPECT_EQ(contents(folder_ / "b.csv"), text);
}

TEST_F(Layout, PositionsGetTheTypeAskedForInEveryOutputThatHasOne) {
  write("a.txt", "x y z\n0.5 1.25 2\n3 4 5\n");
  made("run a.txt a.las -q --pipeline 'decimate(1)'");
  for (const char* in : {"a.txt", "a.las"})
    for (const char* out : {"out.pcd", "out.ply"})
      for (const char* pipeline : {"decimate(1)", "set(x = x + 1)", "where(x < 9) | set(w = 1)"})
        for (const auto& [name, type] : {std::pair{"float32", Type::f32}, std::pair{"float64", Type::f64}}) {
          made(fmt::format("run {} {} -q -f --positions {} --pipeline '{}'", in, out, name, pipeline));
          for (const char* axis : {"x", "y", "z"}) EXPECT_EQ(field(out, axis).type, type) << in << out << pipeline;
          EXPECT_EQ(values(out, "y"), (std::vector<double>{1.25, 4})) << in << out << pipeline;
        }
  refused(2, "run a.txt out.las --positions float32 --pipeline 'set(x = x + 1)'", "stores coordinates as integers");
  refused(1, "run a.txt out.ply -f --positions float32 --pipeline 'set(x = 1e300 where z > 4)'", "ow 1");
}

TEST_F(Layout, ColorsRaiseThePointFormat) {
  write("a.txt", "x y z intensity\n0.5 1.25 2 7\n3 4 5 8\n3 4 7 9\n");
  made("run a.txt a.las -q --pipeline 'decimate(1)'");
  EXPECT_NE(format("a.las").find("point format 6"), std::string::npos) << format("a.las");
  for (const char* pipeline :
       {"color(z)", "color(z, bits=8)", "color(z, bits=16)", "set(red = 65535, green = z * 100, blue = 0)"}) {
    made(fmt::format("run a.las c.las -q -f --pipeline '{}'", pipeline));
    EXPECT_NE(format("c.las").find("point format 7"), std::string::npos) << pipeline << format("c.las");
    for (const char* color : {"red", "green", "blue"}) EXPECT_EQ(field("c.las", color).type, Type::u16) << pipeline;
    EXPECT_EQ(values("c.las", "x"), values("a.las", "x"));
    EXPECT_EQ(values("c.las", "intensity"), values("a.las", "intensity"));
    EXPECT_EQ(tool("verify c.las").status, 0) << tool("verify c.las").out;
  }
}

TEST_F(Layout, ColorsKeepTheirBrightness) {
  write("a.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
        "0 0 0 255 128 0\n1 0 0 1 2 3\n2 5 1 77 88 99\n");
  const Result wide = tool("run a.ply a.las --pipeline 'decimate(1)'");
  EXPECT_NE(wide.err.find("times 257"), std::string::npos) << wide.err;
  EXPECT_EQ(values("a.las", "red"), (std::vector<double>{65535, 257, 77 * 257}));
  EXPECT_EQ(values("a.las", "blue"), (std::vector<double>{0, 771, 99 * 257}));
  made("run a.las b.ply --pipeline 'decimate(1)'");
  for (const char* color : {"red", "green", "blue"})
    EXPECT_EQ(values("b.ply", color), values("a.las", color)) << "16 bits are kept, since 8 might lose something";
  EXPECT_EQ(tool("verify a.ply a.las").status, 0);
  const Result same = tool("run a.las c.las --pipeline 'decimate(1)'");
  EXPECT_EQ(same.err.find("257"), std::string::npos) << same.err;
  EXPECT_EQ(values("c.las", "red"), values("a.las", "red"));
  made("run a.las a.ply -o both.las -q --pipeline 'decimate(1)'");
  EXPECT_EQ(values("both.las", "green"), (std::vector<double>{128 * 257, 514, 88 * 257, 128 * 257, 514, 88 * 257}));
}

TEST_F(Layout, TheFirstRowIsNamedForAnyNumberOfThreads) {
  std::string text = "x y z level\n";
  for (int i = 0; i < 30000; ++i) text += fmt::format("{} {} {} {}\n", i * 7919 % 30011, i % 3, 0, i % 40 + (i > 5017));
  write("a.txt", text);
  for (const auto& [row, pipeline] :
       {std::pair{39, "set(w = level * 100 where level > 38, as=uint8)"}, std::pair{37, "set(w = 7 * level, as=uint8)"},
        std::pair{37, "knn(k=4) | normals | set(w = 7 * level + nx * 0, as=uint8)"}}) {
    for (const int threads : {1, 2, 5, 16}) {
      const Result result = tool(fmt::format("run a.txt out.ply -f --threads {} --pipeline '{}'", threads, pipeline));
      EXPECT_EQ(result.status, 1);
      EXPECT_NE(result.err.find(fmt::format("row {}:", row)), std::string::npos) << pipeline << result.err;
    }
  }
}

TEST_F(Layout, ALineSaysByHowMuchFloat32RoundsLargeCoordinates) {
  std::string text = "x y z\n";
  for (int i = 0; i < 400; ++i) text += fmt::format("{} {} {}\n", 684766.42 + i, 5403215.17 + i % 20, 243.1 + i % 7);
  write("map.txt", text);
  made("convert map.txt map.las -q");
  const std::string by = "rounds them by at most 0.25; transform(translate=[-685000, -5403000, 0]) before would";
  const std::string moved = "transform(translate=[-685000, -5403000, 0])";
  for (const char* in : {"map.txt", "map.las"})
    for (const char* how : {"out.ply", "out.pcd", "out.ply --order sweep", "out.ply --threads 3 --memory 40M",
                            "-o tiles/ --output-format ply", "-o parts/ --output-format ply --tile 100"}) {
      const std::string run = fmt::format("run {} {} -f --positions float32", in, how);
      const Result plain = tool(run);
      ASSERT_EQ(plain.status, 0) << plain.err;
      EXPECT_NE(plain.err.find(by), std::string::npos) << run << plain.err;
      for (const char* before : {"knn(k=3) | normals | ", "where(z > 0) | ", ""}) {
        const Result near = tool(fmt::format("{} --pipeline '{}{}'", run, before, moved));
        ASSERT_EQ(near.status, 0) << near.err;
        EXPECT_NE(near.err.find("as float32, which rounds them by at most 7.6e-06."), std::string::npos) << near.err;
      }
      EXPECT_EQ(tool(fmt::format("run {} {} -f", in, how)).err.find("float32"), std::string::npos);
    }
  made("run map.txt near.ply -f -q --positions float32 --pipeline '" + moved + "'");
  const Result same = tool("run near.ply again.ply -f --positions float32");
  EXPECT_EQ(same.err.find("rounds them"), std::string::npos) << "nothing is rounded: " << same.err;
}

/// Returns a text file in which rows 39, 79, ... have a level of at least 39. With `has_nan`, row 2, which has no
/// finite coordinates, has such a level as well.
std::string levels(bool has_nan) {
  std::string text = "x y z level\n";
  for (int i = 0; i < 30000; ++i)
    text += fmt::format("{} {} {} {}\n", i * 7919 % 30011, i % 3, has_nan && i == 2 ? "nan" : "0",
                        has_nan && i == 2 ? 40 : i % 40 + (i > 5017));
  return text;
}

TEST_F(Layout, TheFirstRowThatTheOutputCannotHoldIsNamedInEveryOrder) {
  const std::string far = "set(x = 1e300 where level > 38)";
  for (const auto& [row, has_nan, before] :
       {std::tuple{39, false, "knn(k=4) | normals | "}, std::tuple{2, true, "knn(k=4) | normals | "},
        std::tuple{39, false, "knn(k=4) | where(level > 20) | normals | "},
        std::tuple{39, false, "where(level > 20) | "}}) {
    write("a.txt", levels(has_nan));
    for (const char* how : {"--threads 1", "--threads 5", "--order sweep --threads 1", "--order sweep --threads 5",
                            "--order sweep --memory 40M", "--engine reference", "--engine reference --order sweep"}) {
      const Result result =
          tool(fmt::format("run a.txt out.ply -f --positions float32 {} --pipeline '{}'", how, before + far));
      EXPECT_EQ(result.status, 1) << how;
      EXPECT_NE(result.err.find(fmt::format("Row {}: 'x' would be 1e+300", row)), std::string::npos)
          << how << " " << before << result.err;
      EXPECT_FALSE(exists("out.ply"));
    }
  }
}

TEST_F(Layout, ARowThatIsRefusedHasItsNumberInItsOwnFile) {
  std::filesystem::create_directory(folder_ / "in");
  for (const char* name : {"in/a.txt", "in/b.txt"}) write(name, levels(false));
  for (const auto& [pipeline, row] : {std::pair{"where(level > 20) | set(w = level * 7, as=uint8)", "row 37 of "},
                                      std::pair{"where(level > 20) | set(x = 1e300)", "Row 21 of "}}) {
    for (const char* outputs : {"-o all.ply", "-o tiles/ --output-format ply"}) {
      const Result result = tool(fmt::format("run in/ {} --positions float32 --pipeline '{}'", outputs, pipeline));
      EXPECT_EQ(result.status, 1);
      EXPECT_NE(result.err.find(row), std::string::npos) << result.err;
      EXPECT_NE(result.err.find("a.txt: "), std::string::npos) << result.err;
    }
  }
}

TEST_F(Layout, AValueThatAStageCannotReadIsRefused) {
  std::string text = "x y z nx ny nz k1\n";
  for (int i = 0; i < 5000; ++i)
    text += fmt::format("{} {} 0 0 0 {} {}\n", i * 7919 % 5003 / 50, i % 50, i % 11 == 10 ? "1e39" : "1",
                        i % 13 == 12 ? "-4e38" : "2");
  write("a.txt", text);
  write("b.txt", text);
  for (const char* how : {"--threads 1", "--threads 5", "--order sweep --threads 5", "--engine reference"}) {
    for (const auto& [pipeline, field, row] :
         {std::tuple{"knn(k=5) | curvature", "'nz' is 1e+39", 10}, std::tuple{"knn(k=5) | orient", "'nz' is 1e+39", 10},
          std::tuple{"m3c2(cloud=b.txt, cylinder=2, depth=2)", "'nz' is 1e+39", 10},
          std::tuple{"simplify(error=0.1)", "'k1' is -4e+38", 12}}) {
      const bool is_graph = std::string(pipeline).find("orient") != std::string::npos;
      if (is_graph && std::string(how).find("reference") != std::string::npos) continue;
      const Result result = tool(fmt::format("run a.txt out.ply {} --pipeline '{}'", how, pipeline));
      EXPECT_EQ(result.status, 1) << pipeline << result.err;
      EXPECT_NE(result.err.find(fmt::format("Row {}: {}, which is not in the range of float32", row, field)),
                std::string::npos)
          << how << " " << pipeline << result.err;
    }
  }
  made("run a.txt out.ply -q --pipeline 'knn(k=5) | where(nz < 2) | curvature'");
}

}  // namespace
}  // namespace pointsweep
