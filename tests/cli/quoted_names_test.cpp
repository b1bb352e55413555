// SPDX-License-Identifier: MIT
/// Attributes whose names have blanks and signs, in every option that takes an expression or a name.
#include <fmt/format.h>

#include <string>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

/// A cloud of 100 points with the attributes "Pulse width" (0, 1, 2, ...), "a|b" (0, 2, 4, ...) and "c, (d" (7).
class QuotedNames : public Tool {
 protected:
  QuotedNames() {
    std::string text = "x,y,z,Pulse width,\"a|b\",\"c, (d\"\n";
    for (int i = 0; i < 100; ++i) text += fmt::format("{},{},{},{},{},7\n", i % 10, i / 10, i % 7, i, 2 * i);
    write("in.csv", text);
  }
  /// Runs a chain into out.csv, expects that verify finds no difference, and returns the rows of out.csv.
  std::string rows_of(const std::string& pipeline) {
    const Result result = tool("run in.csv out.csv --force --pipeline '" + pipeline + "'");
    EXPECT_EQ(result.status, 0) << pipeline << "\n" << result.err;
    const Result verified = tool("verify in.csv out.csv --pipeline '" + pipeline + "'");
    EXPECT_EQ(verified.status, 0) << pipeline << "\n" << verified.out << verified.err;
    std::string rows, text = contents(folder_ / "out.csv");
    for (std::size_t at = 0, end; at < text.size(); at = end + 1) {
      end = text.find('\n', at);
      if (text[at] != '#') rows += text.substr(at, end + 1 - at);
    }
    return rows;
  }
};

TEST_F(QuotedNames, InConditionsSelectPoints) {
  EXPECT_EQ(rows_of("where(`Pulse width` < 2 || `a|b` == 8 && `c, (d` == 7)"),
            "x,y,z,Pulse_width,a_b,c__(d\n0,0,0,0,0,7\n1,0,1,1,2,7\n4,0,4,4,8,7\n");
  EXPECT_EQ(rows_of("where(`a|b` in (4, 7) and not `Pulse width` > 50)"), "x,y,z,Pulse_width,a_b,c__(d\n2,0,2,2,4,7\n");
}

TEST_F(QuotedNames, AreAssigned) {
  EXPECT_EQ(rows_of("set(`Pulse width` = `c, (d` * 2 where `a|b` <= 2, `new = 1` = `a|b` + 1) | where(`new = 1` < 6)"),
            "x,y,z,Pulse_width,a_b,c__(d,new_=_1\n0,0,0,14,0,7,1\n1,0,1,14,2,7,3\n2,0,2,2,4,7,5\n");
}

TEST_F(QuotedNames, AreDroppedAndKept) {
  EXPECT_EQ(rows_of("drop(`Pulse width`, `c, (d`) | where(x < 1 and y < 2)").substr(0, 22), "x,y,z,a_b\n0,0,0,0\n0,1,");
  made("run in.csv dropped.ply --pipeline 'drop(`c, (d`, `a|b`)'");
  EXPECT_EQ(tool("verify in.csv dropped.ply").status, 0) << "by its record";
  made("convert in.csv kept.ply --keep '`c, (d`,`a|b`'");
  EXPECT_EQ(tool("verify in.csv kept.ply").status, 0) << "by its record";
  EXPECT_EQ(made("convert in.csv kept.csv --keep 'Pulse width'", "kept.csv").substr(0, 18), "x,y,z,Pulse_width\n");
  refused(2, "run in.csv out.csv -f --pipeline 'drop(Puls)'", "the input has x, y, z, Pulse width, a|b, c, (d");
  refused(2, "split in.csv parts --by 'Pulse width'", "set(part = floor(`Pulse width`), as=int32)");
}

TEST_F(QuotedNames, AreColoredAndCounted) {
  const std::string colored = rows_of("color(by=\"Pulse width\")");
  EXPECT_EQ(rows_of("color(`Pulse width`)"), colored);
  rows_of("knn(k=4) | statistics(\"Pulse width_median\", where=`a|b` > 3)");
}

TEST_F(QuotedNames, ThatAFormatDoesNotHoldAreChangedWithAWarning) {
  const std::string changed = ": 'Pulse width' is written as 'Pulse_width', 'a|b' as 'a_b', 'c, (d' as ";
  for (const char* out : {"out.ply", "out.pcd", "out.xyz", "out.csv", "out.e57"}) {
    const Result result = tool(std::string("convert in.csv ") + out);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.err.find(out + changed), std::string::npos) << result.err;
    EXPECT_EQ(tool(std::string("verify in.csv ") + out).status, 0) << out;
  }
  for (const char* out : {"out.las", "out.laz"}) {
    EXPECT_EQ(tool(std::string("convert in.csv ") + out).err.find("is written as"), std::string::npos) << out;
    EXPECT_EQ(tool(std::string("verify in.csv ") + out).status, 0) << out;
  }
  EXPECT_EQ(tool("convert out.ply again.xyz").err.find("is written as"), std::string::npos);
}

TEST_F(QuotedNames, AreSpelledSoInMessages) {
  const Result result = tool("run in.csv out.csv --pipeline 'where(Pulse > 2)'");
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("there are x, y, z, `Pulse width`, `a|b`, `c, (d`"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace pointsweep
