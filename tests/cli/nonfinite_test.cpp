// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/verify.h"
#include "tests/cli/tool.h"
#include "tests/support/every_operator.h"

namespace pointsweep {
namespace {

/// A cloud of a sphere in which some points have no finite coordinates, and the cloud without these points.
class NonfinitePoints : public Tool {
 protected:
  static constexpr int kRows = 9000;  // more than two blocks of rows
  static bool is_lost(int row) {
    return row == 3 || row == 17 || row == 4096 || (row >= 5000 && row < 5005) || row == kRows - 1;
  }
  static constexpr int kLost = 9;

  NonfinitePoints() {
    EXPECT_EQ(tool("generate sphere sphere.xyz -n 9000").status, 0);
    std::istringstream rows(contents(folder_ / "sphere.xyz"));
    std::ostringstream dirty("# x y z row\n", std::ios::ate), clean("# x y z row\n", std::ios::ate);
    int row = 0;
    for (std::string line; std::getline(rows, line);) {
      if (line.starts_with('#')) continue;
      std::istringstream cells(line);
      std::string x, y, z;
      cells >> x >> y >> z;
      if (!is_lost(row)) clean << x << " " << y << " " << z << " " << row << "\n";
      if (is_lost(row)) (row % 2 == 0 ? x : z) = row % 3 == 0 ? "inf" : "nan";
      dirty << x << " " << y << " " << z << " " << row << "\n";
      ++row;
    }
    EXPECT_EQ(row, kRows);
    write("dirty.xyz", dirty.str());
    write("clean.xyz", clean.str());
  }
};

TEST_F(NonfinitePoints, AreDroppedFromLasByDefaultAndOneLineSaysSo) {
  const Result result = tool("normals dirty.xyz out.las --stats s.json --no-provenance");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("Dropped 9 points"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("row 3 of dirty.xyz"), std::string::npos) << result.err;
  EXPECT_EQ(contents(folder_ / "out.las"), made("normals clean.xyz clean.las --no-provenance", "clean.las"));
  const auto stats = nlohmann::json::parse(contents(folder_ / "s.json"));
  EXPECT_EQ(stats["points"], kRows - kLost);
  EXPECT_EQ(stats["nonfinite"], kLost);
  EXPECT_EQ(stats["nonfinite_dropped"], kLost);
  EXPECT_EQ(stats["nonfinite_rows"], nlohmann::json({3, 17, 4096, 5000, 5001, 5002, 5003, 5004, 8999}));
}

TEST_F(NonfinitePoints, AreKeptByOtherFormatsByDefaultAndListedToo) {
  for (const char* out : {"out.ply", "out.csv", "out.xyz"}) {
    ASSERT_EQ(tool(std::string("normals dirty.xyz ") + out + " --stats s.json -f").status, 0);
    EXPECT_NE(tool(std::string("info ") + out).out.find("points      9000"), std::string::npos);
    const auto stats = nlohmann::json::parse(contents(folder_ / "s.json"));
    EXPECT_EQ(stats["points"], kRows);
    EXPECT_EQ(stats["nonfinite"], kLost);
    EXPECT_EQ(stats["nonfinite_dropped"], 0);
    EXPECT_EQ(stats["nonfinite_rows"].size(), 9u);
  }
}

TEST_F(NonfinitePoints, DroppedFromAnyFormatOrderAndVerbLeaveTheOutputOfTheOtherPoints) {
  const std::string formats[] = {"ply", "csv", "xyz", "las"};
  std::size_t turn = 0;  // each verb is tried with two of the formats
  for (const char* verb : {"normals", "sort", "splats --order sweep", "normals --order sweep --memory 40M",
                           "run --pipeline 'normals|splats|fair|reneighbor|resort|normals' --order sweep",
                           "run --pipeline 'normals|splats|fair|reneighbor|normals'", "curvature --engine reference"}) {
    for (const std::string& out : {formats[turn % 4], formats[(turn + 1) % 4]}) {
      const std::string options = std::string(verb) + " --no-provenance --nonfinite drop -f ";
      EXPECT_EQ(made(options + "dirty.xyz a." + out, "a." + out), made(options + "clean.xyz b." + out, "b." + out))
          << options << out;
    }
    ++turn;
  }
}

TEST_F(NonfinitePoints, DroppedFromAGraphLeaveRowsThatCountTheOthers) {
  EXPECT_EQ(made("neighbors dirty.xyz a.npy --nonfinite drop --distances a_d.npy", "a.npy"),
            made("neighbors clean.xyz b.npy --distances b_d.npy", "b.npy"));
  EXPECT_EQ(contents(folder_ / "a_d.npy"), contents(folder_ / "b_d.npy"));
  EXPECT_NE(made("neighbors dirty.xyz kept.npy", "kept.npy").find("(9000, 16)"), std::string::npos);
}

TEST_F(NonfinitePoints, AmongSeveralInputsAreDroppedFromEach) {
  ASSERT_EQ(tool("generate sphere good.las -n 500 --seed 7").status, 0);
  for (const char* out : {"out.las", "out.ply"}) {
    const std::string name(out), end = " --no-provenance -f --nonfinite drop --stats s.json";
    EXPECT_EQ(made("normals dirty.xyz good.las dirty.xyz -o " + name + end, name),
              made("normals clean.xyz good.las clean.xyz -o clean_" + name + end, "clean_" + name));
  }
  ASSERT_EQ(tool("sort dirty.xyz good.las dirty.xyz -o out.las -f --stats s.json").status, 0);
  const auto stats = nlohmann::json::parse(contents(folder_ / "s.json"));
  EXPECT_EQ(stats["nonfinite_dropped"], 2 * kLost);
  EXPECT_EQ(stats["nonfinite_rows"][9], kRows + 500 + 3) << "rows run through the inputs";
}

TEST_F(NonfinitePoints, DroppedAreCountedInTheRowsOfDegenerateResults) {
  write("line.xyz", "nan 0 0\n90 0 0\n91 0 0\n92 0 inf\n93 0 0\n94 0 0\n");
  write("pair.xyz", "nan 0 0\n190 0 0\n191 0 0\n");
  for (const std::string nonfinite : {"drop", "keep"}) {
    made("normals line.xyz dirty.xyz pair.xyz -o out.ply --radius 2 -k 8 --stats s.json -f --nonfinite " + nonfinite);
    const auto stats = nlohmann::json::parse(contents(folder_ / "s.json"));
    EXPECT_EQ(stats["degenerate"], 6);
    EXPECT_EQ(stats["degenerate_rows"], nlohmann::json::parse(R"([{"stage": "normals", "count": 6,
        "rows": [1, 2, 4, 5, 9007, 9008]}])"))
        << nonfinite;
  }
}

TEST_F(NonfinitePoints, AreRefusedWithFileAndRow) {
  ASSERT_EQ(tool("generate sphere good.ply -n 500").status, 0);
  for (const char* verb : {"normals", "sort", "fair"})
    refused(1, std::string(verb) + " good.ply dirty.xyz -o out.ply --nonfinite refuse", "row 3 of dirty.xyz");
  refused(1, "neighbors dirty.xyz out.npy --nonfinite refuse", "row 3 of dirty.xyz");
  EXPECT_EQ(tool("normals clean.xyz good.ply -o out.ply --nonfinite refuse").status, 0);
  refused(2, "normals clean.xyz new.ply --nonfinite lose", "'lose' is not keep, drop or refuse");
}

TEST_F(NonfinitePoints, CannotBeKeptInLas) {
  refused(1, "normals dirty.xyz out.las --nonfinite keep", "row 3 of dirty.xyz");
  refused(1, "sort dirty.xyz out.las --nonfinite keep", "--nonfinite drop");
  EXPECT_FALSE(exists("out.las"));
  EXPECT_EQ(tool("normals clean.xyz out.las --nonfinite keep").status, 0);
}

TEST_F(NonfinitePoints, AloneAreNothingToWrite) {
  write("none.xyz", "nan 0 0\n0 inf 0\n");
  refused(1, "normals none.xyz out.las", "none of the 2 points has finite coordinates");
  EXPECT_EQ(tool("normals none.xyz out.ply").status, 0);
}

TEST_F(NonfinitePoints, DroppedByARunThatIsResumedStayDropped) {
  const std::string options = " --no-provenance --nonfinite drop --order input -k 12 ";
  const std::string whole = made("normals dirty.xyz whole.ply" + options, "whole.ply");
  EXPECT_EQ(made("normals dirty.xyz out.ply --resume there" + options, "out.ply"), whole);
}

TEST_F(NonfinitePoints, ThatWereDroppedAreNoDifferenceToVerify) {
  ASSERT_EQ(tool("normals dirty.xyz out.las -k 12").status, 0);
  ASSERT_EQ(tool("normals dirty.xyz out.ply -k 12 --nonfinite drop --order sweep --no-provenance").status, 0);
  ASSERT_EQ(tool("neighbors dirty.xyz out.npy --nonfinite drop").status, 0);
  EXPECT_EQ(tool("verify dirty.xyz out.las -k 12").status, 0);
  EXPECT_EQ(tool("verify dirty.xyz out.ply -k 12 --nonfinite drop").status, 0);
  EXPECT_EQ(tool("verify dirty.xyz out.npy --nonfinite drop").status, 0);
  refused(1, "verify dirty.xyz out.las -k 12 --nonfinite keep", "out of 9000");
  refused(1, "verify dirty.xyz out.ply -k 12", "out of 9000");
}

TEST_F(NonfinitePoints, OfEveryOperatorAreAsVerifyDerivesThem) {
  std::string text = "x,y,z,nx,ny,nz,classification,intensity\n", other = "x,y,z,classification\n0,0,0,1\n1,1,0,3\n";
  for (int i = 0; i < 40; ++i)
    text += fmt::format("{},{},{},0,0,1,{},{}\n", i % 9 == 4 ? "nan" : fmt::format("{}", 0.3 * (i % 7)),
                        i % 11 == 5 ? "inf" : fmt::format("{}", 0.4 * (i % 6)), 0.1 * (i % 5), i % 4, 10 * i);
  write("dirty.csv", text);
  write("other.csv", other);
  const EveryOperator every({"normal", "classification", "intensity"}, "knn(radius=2)",
                            (folder_ / "other.csv").string());
  for (const OperatorDeclaration& declaration : all_operators()) {
    const std::string pipeline = every.case_of(declaration, every.values_of(declaration)).pipeline;
    SCOPED_TRACE(pipeline);
    for (const std::string order : {"input", "sweep"}) {
      made("run dirty.csv out.ply -f -q --order " + order + " --pipeline '" + pipeline + "'", "out.ply");
      try {
        const Verdict verdict = verify({}, folder_ / "out.ply");
        EXPECT_TRUE(verdict.same()) << to_text(verdict);
      } catch (const UsageError& refusal) {  // for rows that cannot be told from the output
        const std::string sentence = refusal.what();
        EXPECT_TRUE(sentence.starts_with("verify: ")) << sentence;
      }
    }
  }
}

}  // namespace
}  // namespace pointsweep
