// SPDX-License-Identifier: MIT
/// LAS outputs of pipelines that move points. Their coordinate grid is planned from the written positions.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "pointsweep/formats/las_scale.h"
#include "tests/cli/tool.h"
#include "tests/formats/point_files.h"

namespace pointsweep {
namespace {

/// A scan around its scanner on a grid of 0.0001, as one file and as two tiles with offsets of their own.
class MovedGrid : public Tool {
 protected:
  MovedGrid() {
    std::string all = "x y z\n", west = all, east = all;
    for (int i = 0; i < 400; ++i) {
      const int x = i * 7919 % 25000 - 12500, y = i * 104729 % 25000 - 12500, z = i * 37 % 8000;
      const std::string line = fmt::format("{:.4f} {:.4f} {:.4f}\n", x / 1e4, y / 1e4, z / 1e4);
      all += line;
      (i % 2 == 0 ? west : east) += line;
    }
    write("scan.txt", all);
    write("west.txt", west);
    write("east.txt", east);
    for (const char* name : {"scan", "west", "east"})
      made(fmt::format("run {0}.txt {0}.las -q --pipeline 'decimate(1)'", name));
  }
  std::vector<double> values(const std::string& file, const std::string& field) const {
    const auto reader = open_reader(folder_ / file);
    return values_of(*reader, field);
  }
  LasQuantization grid(const std::string& file) const { return open_reader(folder_ / file)->info().las->grid; }

  /// Expects that every point is where the formula places it, within half a step of the grid.
  void expect_moved(const std::string& file, double dx, double dy, double step) const {
    const auto x = values("scan.las", "x"), y = values("scan.las", "y"), z = values("scan.las", "z");
    const auto far_x = values(file, "x"), far_y = values(file, "y"), far_z = values(file, "z");
    ASSERT_EQ(far_x.size(), x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      ASSERT_LE(std::abs(far_x[i] - (x[i] + dx)), step / 2 + 1e-9 * step) << i;
      ASSERT_LE(std::abs(far_y[i] - (y[i] + dy)), step / 2 + 1e-9 * step) << i;
      ASSERT_NEAR(far_z[i], z[i], 1e-9) << i;
    }
  }
};

constexpr const char* kFar = "--pipeline 'set(x = x + 512000, y = y + 5403000)'";

TEST_F(MovedGrid, FarPlacesGetANewOffsetAndKeepTheScale) {
  const std::string bytes = made(fmt::format("run scan.las far.las -q {}", kFar), "far.las");
  const LasQuantization before = grid("scan.las"), after = grid("far.las");
  EXPECT_EQ(before.scale, (Vec3{1e-4, 1e-4, 1e-4}));
  EXPECT_EQ(after.scale, before.scale);
  EXPECT_EQ(after.offset.z, before.offset.z);
  for (const double steps : {(after.offset.x - before.offset.x) / 1e-4, (after.offset.y - before.offset.y) / 1e-4})
    EXPECT_NEAR(steps, std::nearbyint(steps), 1e-4);
  expect_moved("far.las", 512000, 5403000, 1.2e-4);  // doubles near 5403000 lie 1e-9 apart
  for (const char* how : {"--threads 1", "--threads 8", "--memory 64M", "--resume kept"})
    EXPECT_EQ(made(fmt::format("run scan.las again.las -q -f {} {}", kFar, how), "again.las"), bytes) << how;
}

TEST_F(MovedGrid, AnyDistanceIsRightOrRefused) {
  made("run scan.las out.las -q --pipeline 'set(x = x + 1e9)'");
  expect_moved("out.las", 1e9, 0, 1e-4 + 2.4e-7);
  refused(1, "run scan.las no.las --pipeline 'set(x = x * 1e9 where z >= 0.7)'", "give --scale 1,");
  const Result result = tool("run scan.las no.las --pipeline 'set(x = x * 1e9 where z >= 0.7)'");
  EXPECT_NE(result.err.find("x of row 190 is"), std::string::npos) << result.err;  // the first with 37 i >= 7000
  EXPECT_FALSE(exists("no.las"));
}

TEST_F(MovedGrid, PointsThatStayInReachKeepTheGrid) {
  made("run scan.las near.las -q --pipeline 'set(x = x + 1.5)'");
  EXPECT_EQ(grid("near.las").offset, grid("scan.las").offset);
  expect_moved("near.las", 1.5, 0, 1e-6);
}

TEST_F(MovedGrid, OneLineSaysWhatWasRounded) {
  const auto lines = [&](const std::string& arguments) {
    const std::string err = tool(arguments).err;
    std::size_t found = 0;
    for (std::size_t at = err.find("rounded to steps of 0.0001, by at most 5e-05"); at != err.npos;
         at = err.find("rounded to steps", at + 1))
      ++found;
    return found;
  };
  EXPECT_EQ(lines("run scan.las a.las --pipeline 'set(x = x + 0.00003)'"), 1u);
  EXPECT_EQ(lines("run west.las east.las b/ --pipeline 'set(x = x + 0.00003)'"), 1u);
  EXPECT_EQ(lines("run scan.las c.las --pipeline 'set(x = x + 0.3)'"), 0u);
}

TEST_F(MovedGrid, TilesAndTheMergedCloudAgree) {
  made(fmt::format("run west.las east.las far/ -q {}", kFar));
  made(fmt::format("run west.las east.las -o far.las -q {}", kFar));
  EXPECT_EQ(grid("far/west.las").offset, grid("far.las").offset);
  EXPECT_EQ(grid("far/east.las").offset, grid("far.las").offset);
  for (const char* axis : {"x", "y", "z"}) {
    std::vector<double> tiles = values("far/west.las", axis);
    for (const double v : values("far/east.las", axis)) tiles.push_back(v);
    EXPECT_EQ(tiles, values("far.las", axis)) << axis;
  }
}

TEST_F(MovedGrid, TilesWhosePointsDidNotMoveKeepTheirGrid) {
  made("run west.las high.las -q --pipeline 'set(z = z + 50)'");
  made("run high.las east.las out/ -q --pipeline 'set(y = y + 300000 where z < 40)'");
  EXPECT_EQ(grid("out/high.las").offset, grid("high.las").offset);
  EXPECT_EQ(values("out/high.las", "y"), values("high.las", "y"));
  EXPECT_NE(grid("out/east.las").offset, grid("east.las").offset) << "300 km are out of its range";
}

TEST_F(MovedGrid, WorksBehindSelectsAndInEveryOrder) {
  for (const char* order : {"input", "sweep"})
    for (const char* pipeline : {"set(x = x + 512000) | where(z > 0.1)", "where(z > 0.1) | set(x = x + 512000)",
                                 "knn(k=6) | normals | set(x = x + 512000) | reneighbor | density | where(z > 0.1)"}) {
      made(fmt::format("run scan.las out.las -q -f --order {} --pipeline '{}'", order, pipeline));
      made(fmt::format("run scan.las out.ply -q -f --order {} --pipeline '{}'", order, pipeline));
      const auto las = values("out.las", "x"), ply = values("out.ply", "x");
      ASSERT_EQ(las.size(), ply.size());
      for (std::size_t i = 0; i < las.size(); ++i) ASSERT_NEAR(las[i], ply[i], 5.1e-5) << pipeline << order << i;
    }
}

TEST_F(MovedGrid, OtherFormatsBecomeLasAfterAMove) {
  made("run scan.las scan.ply -q --pipeline 'decimate(1)'");
  for (const char* input : {"scan.ply", "scan.txt"}) {
    made(fmt::format("run {} out.las -q -f --pipeline 'set(x = x + 512000)'", input));
    expect_moved("out.las", 512000, 0, 1e-4);
  }
}

TEST_F(MovedGrid, VerifySeesThePlacesThatAReaderGets) {
  made("run scan.las far.las -q --pipeline 'set(x = x + 512000)'");
  EXPECT_EQ(tool("verify far.las").status, 0);
  made("run scan.las other.las -q --pipeline 'set(x = x + 512000.0002)'");
  EXPECT_EQ(tool("verify scan.las other.las --pipeline 'set(x = x + 512000)'").status, 1);
}

}  // namespace
}  // namespace pointsweep
