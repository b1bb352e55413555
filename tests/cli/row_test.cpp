// SPDX-License-Identifier: MIT
/// The name `row` in pipelines of the tool: tiles, LAZ, both orders, `verify`.
#include <fmt/format.h>

#include <random>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class RowStages : public Tool {
 protected:
  /// Writes 700 points to a.txt and 500 others to b.txt, which has the attribute `extra` in place of `level`. Some rows
  /// have no finite x.
  void write_inputs() {
    std::mt19937_64 random(81);
    const auto number = [&] { return static_cast<double>(random() % 1000) / 10; };
    std::string a = "x y z level number\n", b = "x y z extra number\n";
    for (int i = 0; i < 1200; ++i) {
      const std::string x = i % 113 == 9 ? "nan" : fmt::format("{}", number());
      (i < 700 ? a : b) += fmt::format("{} {} {} {} {}\n", x, number(), number() / 10, i % 7, i);
    }
    write("in/a.txt", a);
    write("in/b.txt", b);
  }
};

TEST_F(RowStages, CountTheRowsOfAllInputsInEveryFormatTilingAndOrder) {
  std::filesystem::create_directory(folder_ / "in");
  write_inputs();
  const std::string pipeline =
      " -f --pipeline 'knn(k=5) | where(row between 100 and 1000) | set(id = row, as=uint32) | where(number != id)'";
  for (const char* how : {"out.ply", "out.laz", "out.txt --order sweep", "out.laz --order sweep",
                          "out.las --threads 64", "out.txt --memory 64M --threads 2 --nonfinite drop"})
    for (const char* inputs : {"in/a.txt in/b.txt", "in"}) {
      const Result none = tool(fmt::format("run {} -o {}{}", inputs, how, pipeline));
      EXPECT_EQ(none.status, 0) << none.err;
      EXPECT_NE(none.err.find("no point passed"), std::string::npos) << how << none.err;
    }
  const std::string kept = " -f -q --pipeline 'where(level == 3 || extra == 3) | set(id = row, as=uint32)'";
  made("run in out.laz" + kept);
  EXPECT_EQ(tool("verify in out.laz").status, 0);
  made("run in tiles/" + kept);
  EXPECT_EQ(tool("verify in tiles/").status, 0);
  made("run in/a.txt in/b.txt -o out.ply --nonfinite drop" + kept);
  EXPECT_EQ(tool("verify in out.ply").status, 0);
  made("convert out.ply merged.csv -f -q --keep number,id");
  made("convert tiles/a.txt tiles/b.txt tiled.csv -f -q --keep number,id --nonfinite drop");
  EXPECT_EQ(contents(folder_ / "merged.csv"), contents(folder_ / "tiled.csv"));
  made("run out.laz again.laz -f -q --pipeline 'where(row < 20) | where(id != number)'");
  EXPECT_EQ(tool("verify again.laz").status, 0);
}

TEST_F(RowStages, VerifyFindsAWrongNumberAndAWrongRow) {
  std::filesystem::create_directory(folder_ / "in");
  write_inputs();
  made("run in out.txt -f -q --no-provenance --pipeline 'where(row >= 1190) | set(id = row, as=uint32)'");
  const std::string text = contents(folder_ / "out.txt"), check = "verify in wrong.txt --pipeline ";
  write("wrong.txt", text);
  EXPECT_EQ(tool(check + "'where(row >= 1190) | set(id = row, as=uint32)'").status, 0);
  refused(1, check + "'where(row >= 1190) | set(id = row + 1, as=uint32)'", "id is ");
  refused(1, check + "'where(row >= 1189) | set(id = row, as=uint32)'", "10 points came out of 11");
}

}  // namespace
}  // namespace pointsweep
