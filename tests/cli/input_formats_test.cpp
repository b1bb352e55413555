// SPDX-License-Identifier: MIT
/// Runs over formats that are only read have the results of runs over PLY, for all threads, memory and orders.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <sstream>
#include <vector>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

using testing::HasSubstr;

std::string reversed_bytes(const std::string& bytes, std::size_t size) {
  std::string out;
  for (std::size_t at = 0; at < bytes.size(); at += size) {
    const std::string value = bytes.substr(at, size);
    out.append(value.rbegin(), value.rend());
  }
  return out;
}

/// One cloud of float32 coordinates in every format, written by the rules of the formats and not by the tool.
class InputFormats : public Tool {
 protected:
  static constexpr int kPoints = 30000;

  InputFormats() {
    std::string floats, kitti, columns[3];
    for (int i = 0; i < kPoints; ++i) {
      const double u = i * 0.6180339887498949, height = (i + 0.5) / kPoints;
      const float p[4] = {static_cast<float>(std::cos(6.28 * u)), static_cast<float>(std::sin(6.28 * u)),
                          static_cast<float>(4 * height), static_cast<float>(i % 256)};
      floats.append(reinterpret_cast<const char*>(p), 12);
      kitti.append(reinterpret_cast<const char*>(p), 16);
      for (int axis = 0; axis < 3; ++axis) columns[axis].append(reinterpret_cast<const char*>(&p[axis]), 4);
      lines_ += fmt::format("{} {} {}\n", p[0], p[1], p[2]);
    }
    const std::string identity = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
    write("a.ptx", fmt::format("2\n{}\n", kPoints / 2) + identity + lines_);
    write("a.pts", fmt::format("{}\n", kPoints) + lines_);
    write("text.vtk",
          fmt::format("# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS {} float\n", kPoints) + lines_);
    write("binary.vtk",
          fmt::format("# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\nPOINTS {} float\n", kPoints) +
              reversed_bytes(floats, 4));
    write("c.npy", npy(false) + floats);
    write("fortran.npy", npy(true) + columns[0] + columns[1] + columns[2]);
    write("kitti.bin", kitti);
    write("a.xyz", lines_);
  }

  static std::string npy(bool fortran) {
    const std::string dictionary =
        fmt::format("{{'descr': '<f4', 'fortran_order': {}, 'shape': ({}, 3)}}", fortran ? "True" : "False", kPoints);
    return std::string("\x93NUMPY\x01\0", 8) + static_cast<char>(dictionary.size()) + '\0' + dictionary;
  }

  /// Returns the columns `x y z nx ny nz` of a run over `name`, as text.
  std::string normals_of(const std::string& name, const std::string& options) {
    return made("normals " + name + " out.csv --format kitti --keep x,y,z,nx,ny,nz --force --quiet " + options,
                "out.csv");
  }

  std::string lines_;
};

constexpr const char* kNames[] = {"a.ptx", "a.pts", "text.vtk", "binary.vtk", "c.npy", "fortran.npy", "kitti.bin"};

TEST_F(InputFormats, GiveTheResultsOfTextInAllWaysToRun) {
  for (const char* options : {"", "--order sweep", "--memory 40M", "--order sweep --memory 40M --threads 1"}) {
    // float32 coordinates in their shortest decimals are other float64 values, so every text format is compared with
    // text.
    const std::string text = normals_of("a.xyz", options), floats = normals_of("c.npy", options);
    for (const std::string name : kNames) {
      SCOPED_TRACE(name + " " + options);
      const bool is_text = name == "a.ptx" || name == "a.pts";
      EXPECT_TRUE(normals_of(name, options) == (is_text ? text : floats));
    }
  }
}

TEST_F(InputFormats, AreVerifiedWithoutOptions) {
  for (const std::string name : kNames) {
    SCOPED_TRACE(name);
    made("normals " + name + " out.ply --format kitti --force --quiet");
    EXPECT_THAT(tool("verify out.ply --sample 100").out, HasSubstr("points             30,000\n"));
    made("verify out.ply --sample 100");
  }
}

TEST_F(InputFormats, AreMergedWithEachOtherInBothOrders) {
  for (const std::string first : kNames)
    for (const std::string second : {"text.vtk", "kitti.bin", "a.ptx"}) {
      if (first == second) continue;
      SCOPED_TRACE(first + " " + second);
      made("sort " + first + " " + second + " -o out.ply --force --quiet --format kitti");
      made("verify " + first + " " + second + " out.ply --sample 10 --quiet --format kitti --order sweep");
    }
}

TEST_F(InputFormats, AreResumed) {
  for (const std::string name : kNames) {
    SCOPED_TRACE(name);
    const std::string run = "normals " + name + " out.ply --format kitti --force --quiet";
    const std::string right = made(run, "out.ply");
    std::filesystem::remove_all(folder_ / "done");
    made(run + " --resume done --checkpoint-seconds 0 --memory 64M");
    EXPECT_TRUE(contents(folder_ / "out.ply") == right);
  }
  write("kitti.bin", std::string(4800, '\0'));
  made("info kitti.bin --format float32-xyz");
}

TEST_F(InputFormats, AreShownByInfoAndRender) {
  for (const std::string name : kNames) {
    SCOPED_TRACE(name);
    EXPECT_THAT(tool("info " + name + " --format kitti").out, HasSubstr("30000"));
    EXPECT_EQ(made("render " + name + " p.png --size 320x240 --force --format kitti --quiet", "p.png").substr(1, 3),
              "PNG");
  }
}

TEST_F(InputFormats, PointsThatAreNotFiniteFollowTheRule) {
  write("nan.ptx",
        "1\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3\nnan nan nan\n0 0 0\n4 5 6\n");
  write("nan.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n1 2 3 nan 0 0 4 5 6\n");
  for (const std::string name : {"nan.ptx", "nan.vtk"}) {
    SCOPED_TRACE(name);
    EXPECT_THAT(made("normals " + name + " out.csv --force --quiet", "out.csv"), HasSubstr("nan"));
    const std::string dropped = made("normals " + name + " out.csv --force --quiet --nonfinite drop", "out.csv");
    EXPECT_EQ(dropped.find("nan"), dropped.npos);
    EXPECT_EQ(std::count(dropped.begin(), dropped.end(), '\n'), 3);
    refused(1, "normals " + name + " out.csv --force --nonfinite refuse", "row 1 of");
  }
}

/// Files whose rows have a word, a skipped value, a missing value and colours; `columns` names their columns.
class StatedColumns : public Tool {
 protected:
  StatedColumns() {
    for (int i = 0; i < kRows; ++i)
      rows_ += fmt::format("p{} {} {} {} 7 {} {}\n", i, i * 0.25, i % 50, i % 7,
                           i == 3 ? "nan" : std::to_string(i % 90), i % 256);
    write("in.xyz", rows_);
    std::string plain = "x y z intensity red\n";
    for (int i = 0; i < kRows; ++i)
      plain +=
          fmt::format("{} {} {} {} {}\n", i * 0.25, i % 50, i % 7, i == 3 ? "nan" : std::to_string(i % 90), i % 256);
    write("plain.txt", plain);
  }

  static constexpr int kRows = 5000;
  static constexpr const char* kColumns = " --columns -,x,y,z,-,intensity,red ";
  std::string rows_;
};

TEST_F(StatedColumns, GiveTheOutputOfTheSameRowsWithAHeader) {
  for (const char* chain : {"decimate(1)", "knn(k=6) | normals", "set(z = z + 1) | where(red > 100)"}) {
    SCOPED_TRACE(chain);
    for (const char* output : {"out.csv", "out.ply"}) {
      const std::string rest = fmt::format(" {} --pipeline '{}' --force --no-provenance --quiet", output, chain);
      const std::string expected = made("run plain.txt" + rest, output);
      EXPECT_EQ(made("run in.xyz" + rest + kColumns + "--threads 1", output), expected);
      EXPECT_EQ(made("run in.xyz" + rest + kColumns + "--threads 2 --memory 64M", output), expected);
      EXPECT_EQ(made("run - " + rest + kColumns + "< in.xyz #", output), expected);
    }
  }
}

TEST_F(StatedColumns, AreInTheRecordSoThatVerifyReadsTheInputAlike) {
  made(std::string("run in.xyz out.ply --pipeline 'knn(k=6) | normals' --quiet") + kColumns, "out.ply");
  EXPECT_THAT(contents(folder_ / "out.ply"), HasSubstr("pointsweep format text:-,x,y,z,-,intensity,red\n"));
  EXPECT_EQ(tool("verify out.ply").status, 0) << tool("verify out.ply").err;
  made(std::string("convert in.xyz out.laz --nonfinite drop --keep x,y,z,red --quiet") + kColumns, "out.laz");
  EXPECT_EQ(tool("verify out.laz").status, 0) << tool("verify out.laz").err;
}

TEST_F(StatedColumns, HoldForTextFilesAloneAndInFoldersOfTiles) {
  made("convert plain.txt other.ply --quiet", "other.ply");
  std::filesystem::create_directory(folder_ / "tiles");
  write("tiles/a.xyz", rows_);
  write("tiles/notes.txt", "These are notes\nabout the tiles\n");
  std::filesystem::copy(folder_ / "other.ply", folder_ / "tiles/b.ply");
  made(std::string("convert tiles out/ --output-format csv --quiet") + kColumns, "out/a.csv");
  EXPECT_EQ(contents(folder_ / "out/a.csv"), contents(folder_ / "out/b.csv"));
  EXPECT_FALSE(exists("out/notes.csv"));
  refused(2, std::string("convert other.ply out.csv") + kColumns, "--columns: no input is text");
}

TEST_F(StatedColumns, SaysWhatIsWrong) {
  refused(1, "convert in.xyz out.csv --columns x,y,z",
          "in.xyz: line 1 has 7 values where 3 are expected (as --columns names)");
  refused(1, "convert in.xyz out.csv --columns x,-,y,z,-,intensity,red", "line 1: 'p0' in column 'x' is no number");
  refused(2, "convert in.xyz out.csv --columns x,y,-", "--columns: 'x,y,-' does not name z; a point needs x, y and z");
  refused(2, "convert in.xyz out.csv --columns x,y,z,i,intensity", "'i' and 'intensity' name the same attribute");
  refused(2, "convert in.xyz out.csv --columns x,y,,z", "is not a list of names such as");
  refused(2, "convert in.xyz out.csv --format kitti --columns x,y,z",
          "--columns: another option says how the inputs are read");
}

TEST_F(InputFormats, AnUnknownFormatIsAUsageError) {
  refused(2, "normals a.xyz out.ply --format las", "--format: 'las' is not one of kitti|float32-xyz");
  refused(1, "normals kitti.bin out.ply", "name their format with --format kitti or float32-xyz");
}

}  // namespace
}  // namespace pointsweep
