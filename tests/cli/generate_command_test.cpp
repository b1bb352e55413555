// SPDX-License-Identifier: MIT
#include "pointsweep/program/generate.h"
#include "pointsweep/reader.h"
#include "pointsweep/shapes/registry.h"
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

using Generate = Tool;

TEST_F(Generate, WritesTheRowsOfTheShape) {
  for (const auto& shape : all_shapes()) {
    ASSERT_EQ(tool("generate " + shape->name() + " out.ply -n 3000 --force").status, 0);
    const auto file = open_reader(folder_ / "out.ply");
    const auto expected = generated_points(shape->name(), {.count = 3000});
    ASSERT_EQ(file->info().schema, expected->info().schema);
    ASSERT_EQ(file->info().count, 3000u);
    std::vector<std::byte> read(3000 * file->info().schema.stride), wanted(read.size());
    EXPECT_EQ(file->read(0, read), 3000u);
    expected->read(0, wanted);
    EXPECT_EQ(read, wanted) << shape->name();
  }
}

TEST_F(Generate, WritesManyBlocksInOrder) {
  const std::string all = made("generate volume all.ply -n 700k", "all.ply");
  const std::string start = made("generate volume start.ply -n 100", "start.ply");
  const std::size_t header_end = all.find("end_header\n") + 11, start_end = start.find("end_header\n") + 11;
  EXPECT_EQ(all.size() - header_end, 700'000u * 12);
  EXPECT_EQ(all.substr(header_end, 1200), start.substr(start_end));
}

TEST_F(Generate, EveryOptionChangesTheFile) {
  const std::string plain = made("generate torus a.ply -n 1000", "a.ply");
  for (const char* option : {"--seed 2", "--noise 0.01", "--outliers 0.1", "--origin 1,2,3", "--double", "-n 1001"}) {
    const std::string points = std::string(option).starts_with("-n") ? "" : " -n 1000 ";
    EXPECT_NE(made("generate torus b.ply --force " + points + option, "b.ply"), plain) << option;
  }
  EXPECT_NE(made("generate torus b.ply -n 1000 --force --outliers 0.1 --outlier-box 5", "b.ply"),
            made("generate torus c.ply -n 1000 --outliers 0.1", "c.ply"));
  EXPECT_EQ(made("generate torus b.ply -n 1k --seed 1 --noise 0 --force", "b.ply"), plain);
}

TEST_F(Generate, MakesTheSameBytesWithAnyNumberOfThreads) {
  EXPECT_EQ(made("generate tls a.ply -n 50000 --threads 1", "a.ply"),
            made("generate tls b.ply -n 50000 --threads 4", "b.ply"));
}

TEST_F(Generate, ChoosesTheFormatByTheExtension) {
  EXPECT_TRUE(made("generate sphere a.ply -n 10", "a.ply").starts_with("ply\n"));
  EXPECT_EQ(made("generate sphere a.xyz -n 10", "a.xyz").find("ply"), std::string::npos);
  refused(2, "generate sphere a.bunny -n 10", "bunny");
}

TEST_F(Generate, RefusesToReplaceAFileUnlessForced) {
  write("a.ply", "precious");
  refused(1, "generate sphere a.ply -n 10", "a.ply");
  EXPECT_EQ(contents(folder_ / "a.ply"), "precious");
  EXPECT_NE(made("generate sphere a.ply -n 10 --force", "a.ply"), "precious");
}

TEST_F(Generate, SaysWhatItDidUnlessQuiet) {
  EXPECT_NE(tool("generate sphere a.ply -n 10").err.find("wrote a.ply: 10 points"), std::string::npos);
  EXPECT_EQ(tool("generate sphere b.ply -n 10 --quiet").err, "");
  EXPECT_EQ(tool("generate sphere c.ply -n 10 -q").out, "");
}

TEST_F(Generate, ReportsProgressToPrograms) {
  const Result result = tool("generate sphere a.ply -n 600k --progress-fd 7 7>progress");
  EXPECT_EQ(result.status, 0);
  const std::string progress = contents(folder_ / "progress");
  EXPECT_TRUE(progress.starts_with(R"({"phase":"generate","done":0,"total":600000,)")) << progress;
  EXPECT_NE(progress.find(R"({"phase":"generate","done":600000,"total":600000,)"), std::string::npos) << progress;
}

TEST_F(Generate, RefusesWhatMakesNoSense) {
  refused(2, "generate bunny a.ply -n 10", "no shape is called 'bunny'");
  refused(2, "generate sphere a.ply", "--points is required");
  refused(2, "generate sphere a.ply -n many", "'many' is not a whole number");
  refused(2, "generate sphere a.ply -n -5", "'-5' is not a whole number");
  refused(2, "generate sphere a.ply -n 10 --outliers 2", "outliers");
  refused(2, "generate sphere a.ply -n 10 --noise -1", "noise");
  refused(2, "generate sphere a.ply -n 10 --outlier-box 0", "outlier box");
  refused(2, "generate sphere a.ply -n 10 --origin 1,2", "X,Y,Z");
  refused(2, "generate sphere a.ply -n 10 --threads 0", "--threads");
  refused(2, "generate sphere a.ply -n 10 --progress-fd 77", "descriptor 77 is not open");
  refused(2, "generate sphere a.ply -n 10 --memory 1G", "--memory");
  refused(1, "generate sphere missing/a.ply -n 10", "missing");
  EXPECT_FALSE(exists("a.ply"));
}

}  // namespace
}  // namespace pointsweep
