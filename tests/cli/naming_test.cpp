// SPDX-License-Identifier: MIT
#include <algorithm>
#include <sstream>
#include <vector>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

/// Inputs with attributes whose names the computed attributes would take.
class Naming : public Tool {
 protected:
  Naming() {
    std::string rows;
    for (int i = 0; i < 60; ++i) {
      const double x = i % 10, y = i / 10;
      rows += std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(0.01 * (x * x + i % 3)) + " 5 1 0 0\n";
    }
    write("in.xyz", "# x y z curvature nx ny nz\n" + rows);
    write("plain.xyz", "# x y z curvature\n0 0 0 5\n1 0 0 5\n0 1 0 5\n1 1 0.1 5\n");
    EXPECT_EQ(tool("sort in.xyz in.ply --axis x --no-provenance").status, 0);
    EXPECT_EQ(tool("sort in.xyz in.las --axis x --no-provenance").status, 0);
  }

  /// Returns the values of a column as text.
  std::vector<std::string> column(const std::string& file, const std::string& name) {
    EXPECT_EQ(tool("sort " + file + " column.csv --axis x -f --no-provenance").status, 0);
    std::istringstream lines(contents(folder_ / "column.csv"));
    std::string line, cell;
    std::getline(lines, line);
    std::istringstream names(line);
    std::size_t wanted = 0;
    while (std::getline(names, cell, ',') && cell != name) ++wanted;
    EXPECT_EQ(cell, name) << line;
    std::vector<std::string> cells;
    while (std::getline(lines, line)) {
      std::istringstream row(line);
      for (std::size_t i = 0; i <= wanted; ++i) std::getline(row, cell, ',');
      cells.push_back(cell);
    }
    return cells;
  }
  void expect_all(const std::string& file, const std::string& name, const std::string& value) {
    const auto cells = column(file, name);
    EXPECT_EQ(std::count(cells.begin(), cells.end(), value), std::ssize(cells)) << file << " " << name;
  }
  void expect_made(const std::string& file, const std::string& name, const std::string& old) {
    const auto cells = column(file, name);
    EXPECT_LT(std::count(cells.begin(), cells.end(), old), std::ssize(cells)) << file << " " << name;
  }
};

TEST_F(Naming, AnAttributeCalledCurvatureIsNotReplacedBySurfaceVariation) {
  for (const char* in : {"in.xyz", "in.ply", "in.las"})
    for (const char* out : {"out.ply", "out.las", "out.xyz", "out.csv"})
      for (const char* run : {"", " --dry-run"}) {
        const std::string files = std::string(in) + " " + out + run;
        refused(2, "curvature " + files, "--prefix NAME");
        refused(2, "run --pipeline 'normals | curvature' " + files, "--replace ");
        EXPECT_FALSE(exists(out));
      }
  refused(2, "curvature in.ply out.ply",
          "in.ply: the computed 'surface_variation' would overwrite its attribute 'curvature'");
  refused(2, "curvature in.las out.las", "would overwrite its attribute 'Curvature'");
  write("chain.json", "[{\"type\": \"normals\"}, {\"type\": \"curvature\"}]");
  refused(2, "run --pipeline chain.json in.ply out.ply", "--replace curvature");
}

TEST_F(Naming, WhatIsNotKeptTakesNoName) {
  for (const char* out : {"out.ply", "out.las", "out.csv"})
    ASSERT_EQ(tool(std::string("curvature in.xyz ") + out + " --keep k1,k2").status, 0);
  expect_all("out.ply", "curvature", "5");
  expect_all("out.las", "Curvature", "5");
  expect_all("out.csv", "curvature", "5");
}

TEST_F(Naming, ReplaceOverwritesTheNamedAttributeOnly) {
  for (const char* name : {"curvature", "Curvature", "surface_variation"}) {
    ASSERT_EQ(tool(std::string("curvature in.xyz out.ply -f --replace ") + name).status, 0);
    expect_made("out.ply", "curvature", "5");
  }
  ASSERT_EQ(tool("curvature in.las out.las --replace Curvature").status, 0);
  expect_made("out.las", "Curvature", "5");
  refused(2, "curvature in.xyz out.ply -f --replace curvature,color", "'color'");
  refused(2, "normals plain.xyz out.ply -f --replace curvature", "'curvature'");
}

TEST_F(Naming, PrefixKeepsBoth) {
  for (const char* in : {"in.xyz", "in.ply", "in.las"}) {
    for (const std::string out : {"out.ply", "out.las", "out.csv"}) {
      const Result result = tool(std::string("curvature ") + in + " " + out + " -f --prefix new_");
      ASSERT_EQ(result.status, 0) << result.err;
      EXPECT_EQ(result.err.find("replaced"), std::string::npos) << result.err;
      const bool las = out.ends_with("las") || std::string(in).ends_with("las");
      expect_all(out, las ? "Curvature" : "curvature", "5");
      expect_all(out, las ? "NormalX" : "nx", "1");
      expect_made(out, "new_surface_variation", "5");
      expect_made(out, "new_nx", "1");
    }
  }
  refused(2, "curvature out.ply again.ply --prefix new_", "'new_nx'");
  refused(2, "normals in.ply out.ply --prefix 'a b'", "'a b'");
  refused(2, "curvature in.ply long.las --prefix a_prefix_of_many_letters_", "LAS keeps 32 bytes");
}

TEST_F(Naming, PositionsMoveWithoutPrefix) {
  ASSERT_EQ(tool("fair in.xyz a.csv --no-provenance").status, 0);
  ASSERT_EQ(tool("fair in.xyz b.csv --prefix p_ --no-provenance").status, 0);
  EXPECT_EQ(column("a.csv", "z"), column("b.csv", "z"));
  expect_made("a.csv", "nx", "1");
  expect_all("b.csv", "nx", "1");
  expect_made("b.csv", "p_nx", "1");
  EXPECT_EQ(contents(folder_ / "b.csv").find("p_x"), std::string::npos);
}

TEST_F(Naming, WhatWasAskedForByItsNameIsReplacedWithOneWarning) {
  for (const char* files : {"in.xyz out.ply", "in.ply out.ply", "in.las out.las", "in.las out.ply", "in.ply out.las"}) {
    for (const char* verb : {"normals ", "run --pipeline 'normals' ", "splats "}) {
      const Result result = tool(verb + std::string(files) + " -f");
      ASSERT_EQ(result.status, 0) << result.err;
      const std::size_t warning = result.err.find("with computed values");
      EXPECT_NE(warning, std::string::npos) << result.err;
      EXPECT_EQ(result.err.find("with computed values", warning + 1), std::string::npos) << result.err;
    }
  }
  ASSERT_EQ(tool("normals in.ply out.ply -f").status, 0);
  expect_made("out.ply", "nx", "1");
  ASSERT_EQ(tool("curvature plain.xyz k.ply --keep k1 -k 3").status, 0);
  EXPECT_NE(tool("curvature k.ply k2.ply --keep k1 -k 3").err.find("replacing k1 of the input"), std::string::npos);
  const Result dry = tool("run in.ply new.ply --pipeline normals --dry-run");
  EXPECT_NE(dry.out.find("replacing nx, ny, nz of the input"), std::string::npos) << dry.out;
}

}  // namespace
}  // namespace pointsweep
