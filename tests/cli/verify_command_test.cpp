// SPDX-License-Identifier: MIT
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class VerifyVerb : public Tool {
 protected:
  VerifyVerb() { EXPECT_EQ(tool("generate statue in.ply -n 4000 --noise 0.002").status, 0); }

  static std::string last_line(const std::string& text) { return text.substr(text.rfind('\n', text.size() - 2) + 1); }
  void same(const std::string& arguments, const std::string& words = "") {
    const Result result = tool("verify " + arguments);
    EXPECT_EQ(result.status, 0) << arguments << "\n" << result.out << result.err;
    EXPECT_EQ(last_line(result.out).substr(0, 4), "OK: ") << result.out;
    EXPECT_NE(result.out.find(words), std::string::npos) << result.out;
  }
};

TEST_F(VerifyVerb, AcceptsWhatEveryVerbWrites) {
  made("normals in.ply out.ply", "out.ply");
  same("in.ply out.ply", "4,000 of 4,000 points, 0 wrong: normal");
  made("normals in.ply k.las -k 12 --order sweep --axis x", "k.las");
  same("in.ply k.las -k 12 --axis x", "sweep along x");
  made("normals in.ply r.xyz --radius 0.05", "r.xyz");
  same("in.ply r.xyz --radius 0.05");
  made("curvature in.ply c.ply --keep k1,k2", "c.ply");
  same("in.ply c.ply", "0 wrong: k1 k2");
  made("splats in.ply s.csv", "s.csv");
  same("in.ply s.csv --sample 100", "100 of 4,000 points");
  made("fair in.ply f.ply -k 16", "f.ply");
  same("in.ply f.ply --sample 50 --pipeline 'knn(k=16) | normals | splats | fair | normals | splats'");
  made("sort in.ply sorted.ply", "sorted.ply");
  same("in.ply sorted.ply", "none, so no neighbourhoods were looked at");
  made("neighbors in.ply n.npy -k 5 --distances d.npy", "n.npy");
  same("in.ply n.npy", "0 wrong: neighbors");
  same("in.ply d.npy -k 5", "0 wrong: distances");
}

TEST_F(VerifyVerb, SaysWhatItCannotCheckOfPointsThatGotNewNeighbors) {
  const std::string pipeline = " --pipeline 'knn(k=12) | normals | splats | fair | reneighbor | normals'";
  made("run in.ply m.ply" + pipeline, "m.ply");
  const Result result = tool("verify in.ply m.ply --sample 50" + pipeline);
  EXPECT_EQ(result.status, 3) << result.err;
  for (const char* words : {"0 wrong: splat_axis splat_length splat_ratio position\n", "not checked        normal: "})
    EXPECT_NE(result.out.find(words), std::string::npos) << result.out;
  EXPECT_EQ(last_line(result.out), "not checked: 1 attribute; all else is correct\n");
  EXPECT_EQ(result.err, "warning: m.ply: not checked: 1 attribute; all else is correct.\n");
  made("run in.ply o.ply --order sweep --pipeline 'knn(k=12) | normals | splats | fair | resort'", "o.ply");
  refused(2, "verify in.ply o.ply --pipeline 'knn(k=12) | normals | splats | fair | resort'", "order of moved points");
}

TEST_F(VerifyVerb, SeveralInputsAreOneCloud) {
  EXPECT_EQ(tool("generate statue more.ply -n 1000 --seed 2").status, 0);
  made("normals in.ply more.ply both.ply", "both.ply");
  same("in.ply more.ply both.ply");
  refused(1, "verify in.ply both.ply", "5000 points came out of 4000");
}

TEST_F(VerifyVerb, WhatDiffersIsStatus1AndOneSentence) {
  std::string bytes = made("normals in.ply out.ply", "out.ply");
  bytes[bytes.size() - 1] ^= 1;  // nz of the last point
  write("out.ply", bytes);
  const Result result = tool("verify in.ply out.ply");
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(last_line(result.out), "out.ply: 1 of 4,000 samples is wrong\n");
  EXPECT_TRUE(result.err.starts_with("error: out.ply: 1 of 4,000 samples is wrong: row 3999: nz is ")) << result.err;
  EXPECT_EQ(tool("verify in.ply out.ply --quiet").out, "");
}

TEST_F(VerifyVerb, SaysInItsLastLineWhatWasChecked) {
  const auto ends_with = [this](const std::string& arguments, int status, const std::string& line) {
    const Result result = tool("verify " + arguments);
    EXPECT_EQ(result.status, status) << arguments << "\n" << result.out << result.err;
    EXPECT_EQ(last_line(result.out), line + "\n") << arguments << "\n" << result.out;
  };
  made("normals in.ply out.ply", "out.ply");
  ends_with("out.ply", 0, "OK: inputs unchanged, 4,000 samples correct");
  ends_with("out.ply --sample 1", 0, "OK: inputs unchanged, 1 sample correct");
  made("neighbors in.ply n.npy", "n.npy");
  ends_with("in.ply n.npy", 0, "OK: 4,000 samples correct");
  made("sort in.ply sorted.ply", "sorted.ply");
  ends_with("sorted.ply", 0, "OK: inputs unchanged");
  write("two.xyz", "0 0 0\n1 1 1\n2 2 2\n");
  write("other.xyz", "0 0 0\n1 1 3\n2 2 2\n");
  ends_with("two.xyz other.xyz", 1, "other.xyz differs from its input in 1 row");
  write("more.xyz", "x y z weight\n0 0 0 5\n1 1 1 6\n2 2 2 7\n");
  ends_with("two.xyz more.xyz", 3, "not checked: 1 attribute; all else is correct");
}

TEST_F(VerifyVerb, ComparesTwoFilesOfDifferentOrders) {
  write("one.xyz", "x y z a\n0 0 0 1\n2 0 0 2\n1 0 0 3\n0 5 0 4\n");
  write("other.xyz", "x y z a\n2 0 0 2\n0 5 0 4\n1 0 0 3\n0 0 0 1\n");
  same("one.xyz other.xyz", "rows               in another order than those of the input");
  refused(1, "verify one.xyz other.xyz --order input", "row 0: x is 2, but 0 in the input");
  write("other.xyz", "x y z a\n2 0 0 2\n0 5 0 4\n1 0 0 1\n0 0 0 3\n");
  const Result result = tool("verify one.xyz other.xyz");
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.out.find("in the order of the input"), std::string::npos) << result.out;
}

TEST_F(VerifyVerb, KnowsTheComponentsThatLasHasAsSeparateAttributes) {
  write("array.pcd",
        "FIELDS x y z arr\nSIZE 4 4 4 2\nTYPE F F F I\nCOUNT 1 1 1 3\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n"
        "1 2 3 4 5 6\n");
  made("convert array.pcd array.las", "array.las");
  same("array.pcd array.las");
}

TEST_F(VerifyVerb, KnowsWhatE57MakesOfNamesAndOfPointsThatAreNotFinite) {
  write("names.xyz", "x y z H\u00f6he H\u00e4he 1st a.b\n1 2 3 4 5 6 7\n4 5 nan 8 9 10 11\n");
  made("convert names.xyz names.e57", "names.e57");
  same("names.xyz names.e57");
}

/// The data do not determine a normal: all points lie on a line.
TEST_F(VerifyVerb, EndsWithStatus3WhereItCannotDecide) {
  std::string line = "x y z\n";
  for (int i = 0; i < 40; ++i) line += std::to_string(i * i) + " 0 0\n";
  write("line.xyz", line);
  made("run line.xyz out.ply --pipeline 'knn(k=4) | normals | color(nx)'", "out.ply");
  const Result result = tool("verify out.ply");
  EXPECT_EQ(result.status, 3) << result.out;
  EXPECT_NE(last_line(result.out).find("not checked: 40 of "), std::string::npos) << result.out;
}

/// A LAS output has all fields of its point format. Fields that no attribute fills are 0, and returns are 1 of 1.
TEST_F(VerifyVerb, KnowsWhatLasHoldsInFieldsThatNothingFills) {
  made("normals in.ply out.las", "out.las");
  same("out.las");
  made("run out.las other.las --no-provenance --pipeline 'set(user_data = 5 where z > 0)'", "other.las");
  const Result result = tool("verify in.ply other.las --pipeline normals");
  EXPECT_EQ(result.status, 3) << result.out;
  EXPECT_NE(result.out.find("not checked        user_data: "), std::string::npos) << result.out;
}

TEST_F(VerifyVerb, ShowsChecksumsOnlyWhereTheyAreAskedFor) {
  made("sort in.ply sorted.ply", "sorted.ply");
  const std::string without = tool("verify sorted.ply").out, with = tool("verify sorted.ply --checksums").out;
  EXPECT_EQ(without.find("\n  x "), std::string::npos) << without;
  EXPECT_NE(with.find("\n  x "), std::string::npos) << with;
  made("run in.ply o.ply --pipeline 'normals | curvature | simplify(error=0.01)'", "o.ply");
  refused(2, "verify o.ply", "the stage 'simplify' leaves out rows");
}

TEST_F(VerifyVerb, AFolderAloneNamesTheCommandThatHelps) {
  std::filesystem::create_directory(folder_ / "out");
  refused(2, "verify out", "name the inputs too: pointsweep verify tiles/ out");
}

TEST_F(VerifyVerb, RowsNamedInAFileAreCheckedBesidesTheSample) {
  std::string bytes = made("normals in.ply out.ply", "out.ply");
  bytes[bytes.size() - 1] ^= 1;  // nz of the last point
  write("out.ply", bytes);
  write("others.txt",
        "\xEF\xBB\xBF"
        "0 17\n3998\n");
  same("in.ply out.ply --sample 0 --rows others.txt", "3 of 4,000 points, 0 wrong");
  write("last.txt", "17 3999 17\n");
  refused(1, "verify in.ply out.ply --sample 0 --rows last.txt", "row 3999");
  write("beyond.txt", "4000");
  refused(2, "verify in.ply out.ply --rows beyond.txt", "the input has 4000 rows, numbered from 0");
  write("words.txt", "first");
  refused(2, "verify in.ply out.ply --rows words.txt", "--rows");
  refused(2, "verify in.ply out.ply --rows absent.txt", "cannot open absent.txt");
}

TEST_F(VerifyVerb, EveryOptionMatters) {
  made("normals in.ply out.ply", "out.ply");
  EXPECT_NE(tool("verify in.ply out.ply -k 9").status, 0);
  EXPECT_NE(tool("verify in.ply out.ply --radius 0.01").status, 0);
  EXPECT_NE(tool("verify in.ply out.ply --order sweep").status, 0);
  EXPECT_NE(tool("verify in.ply out.ply --pipeline 'normals(orient=up)'").status, 0);
  made("normals in.ply sweep.ply --order sweep", "sweep.ply");
  EXPECT_NE(tool("verify in.ply sweep.ply --axis x").status, 0);
  EXPECT_EQ(tool("verify in.ply sweep.ply --axis z").status, 0) << "the statue is highest";
  made("run in.ply some.ply --pipeline 'normals | splats' --keep normal", "some.ply");
  EXPECT_NE(tool("verify in.ply some.ply --pipeline 'normals | splats'").status, 0);
  same("in.ply some.ply --pipeline 'normals | splats' --keep normal");
  made("fair in.ply f.ply -k 16", "f.ply");
  const std::string fair =
      "in.ply f.ply --pipeline 'knn(k=16) | normals | splats | fair | normals | splats' --sample 500";
  same(fair);
  same(fair + " --memory 2M --seed 7");
}

TEST_F(VerifyVerb, WhatMakesNoSenseIsStatus2) {
  made("normals in.ply out.ply", "out.ply");
  made("neighbors in.ply n.npy", "n.npy");
  refused(2, "verify in.ply", "in.ply: does not say how it was made; name the inputs as well.");
  refused(2, "verify in.ply out.ply -k 0", "-k: knn: k is a whole number");
  refused(2, "verify in.ply out.ply -k 8 --pipeline 'knn(k=8) | normals'",
          "verify: the pipeline says in knn which neighbours it takes; leave out k.");
  refused(2, "verify in.ply out.ply --pipeline fair", "needs 'splat_length'");
  refused(2, "verify in.ply out.ply --order none", "--order");
  refused(2, "verify in.ply n.npy -k 9", "16 columns");
  refused(1, "verify in.ply none.ply", "none.ply");
  write("damaged.txt", "# x y z\n# pointsweep 0.1.0\n# pointsweep stage convert\n# pointsweep decimals many\n0 0 0\n");
  refused(2, "verify in.ply damaged.txt", "the record of the output");
}

}  // namespace
}  // namespace pointsweep
