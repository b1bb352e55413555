// SPDX-License-Identifier: MIT
#include "pointsweep/program/pipeline.h"
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class RunVerb : public Tool {
 protected:
  RunVerb() { EXPECT_EQ(tool("generate statue in.ply -n 4000 --noise 0.002").status, 0); }
};

TEST_F(RunVerb, APipelineOfNormalsIsTheVerbNormals) {
  EXPECT_EQ(made("run in.ply a.ply --pipeline 'knn(k=12) | normals(orient=up)'", "a.ply"),
            made("normals in.ply b.ply -k 12 --orient up", "b.ply"));
  EXPECT_EQ(made("run in.ply c.ply --pipeline normals --order sweep --axis x", "c.ply"),
            made("normals in.ply d.ply --order sweep --axis x", "d.ply"));
}

TEST_F(RunVerb, JsonInlineAndInAFileSayTheSame) {
  const std::string json = R"([{"type": "knn", "k": 12}, {"type": "normals"}])";
  write("chain.json", "{\"pipeline\": " + json + "}\n");
  const std::string text = made("run in.ply a.ply --pipeline 'knn(k=12) | normals'", "a.ply");
  EXPECT_EQ(made("run in.ply b.ply --pipeline '" + json + "'", "b.ply"), text);
  EXPECT_EQ(made("run in.ply c.ply --pipeline chain.json", "c.ply"), text);
}

TEST_F(RunVerb, KeepChoosesWhatIsWritten) {
  const std::string all = made("run in.ply a.ply --pipeline normals", "a.ply");
  EXPECT_EQ(made("run in.ply b.ply --pipeline normals --keep normal", "b.ply"), all);
  refused(2, "run in.ply c.ply --pipeline normals --keep colour", "what is made is normal");
  refused(2, "run in.ply c.ply --pipeline normals --keep normal,", "--keep");
  EXPECT_FALSE(exists("c.ply"));
}

TEST_F(RunVerb, DryRunSaysThePlanAndWritesNothing) {
  const Result result = tool("run in.ply out.ply --pipeline 'knn(k=12) | normals' --dry-run --memory 200M");
  EXPECT_EQ(result.status, 0) << result.err;
  for (const char* words :
       {"4000", "the 12 nearest", "1 normals", "through", "nx ny nz", "12 bytes", "slabs", "200.0 MB"})
    EXPECT_NE(result.out.find(words), std::string::npos) << words << "\n" << result.out;
  EXPECT_FALSE(exists("out.ply"));
  refused(1, "run in.ply out.ply --pipeline normals --dry-run --memory 1M", "too small");
}

TEST_F(RunVerb, WhatMakesNoSenseIsStatus2AndNamesThePlace) {
  refused(2, "run in.ply --pipeline normals", "IN... OUT");
  refused(2, "run in.ply out.ply --pipeline 'knn(k=12) | nromals'", "column 13: no operator is called 'nromals'");
  refused(2, "run in.ply out.ply --pipeline 'knn(k=12'", "column 9");
  refused(2, "run in.ply out.ply --pipeline 'knn(k=12)'", "knn alone computes nothing; add an operator");
  refused(2, "run in.ply out.ply --pipeline 'reneighbor(k=3)'", "computes nothing; add an operator");
  refused(2, "run in.ply out.ply --pipeline '[{\"type\": \"normals\", \"orient\": \"in\"}]'", "stage 1");
  refused(1, "run in.ply out.ply --pipeline none.json", "none.json");
  EXPECT_FALSE(exists("out.ply"));
}

TEST_F(RunVerb, ShortFormsAreTheirPipelines) {
  EXPECT_EQ(made("curvature in.ply a.ply --keep k1,k2", "a.ply"),
            made("run in.ply b.ply --keep k1,k2 --pipeline 'knn(k=32) | normals | curvature'", "b.ply"));
  EXPECT_EQ(made("splats in.ply c.ply --radius 0.1 -k 12", "c.ply"),
            made("run in.ply d.ply --pipeline 'knn(k=12, radius=0.1) | normals | splats'", "d.ply"));
  const std::string fair = " | normals | splats | fair(f=0.3, g=0.7) | normals | splats'";
  EXPECT_EQ(made("fair in.ply e.ply --f 0.3 --g 0.7", "e.ply"),
            made("run in.ply f.ply --pipeline 'knn(k=64)" + fair, "f.ply"));
  refused(2, "fair in.ply g.ply --f 0", "--f: fair: f is a number");
  refused(2, "splats in.ply g.ply -k 0", "-k: knn: k is a whole number");
}

TEST_F(RunVerb, UpdateOperatorsWorkInTextAndJson) {
  const std::string before = "normals | splats | fair(f=2, g=2) | ";
  const std::string updated =
      made("run in.ply a.ply --no-provenance --pipeline '" + before + "reneighbor | normals'", "a.ply");
  EXPECT_NE(updated, made("run in.ply b.ply --no-provenance --pipeline '" + before + "normals'", "b.ply"));
  EXPECT_EQ(
      updated,
      made("run in.ply c.ply --no-provenance --pipeline '[{\"type\": \"normals\"}, {\"type\": \"splats\"}, {\"type\": "
           "\"fair\", \"f\": 2, "
           "\"g\": 2}, {\"type\": \"reneighbor\", \"k\": 64}, {\"type\": \"normals\"}]'",
           "c.ply"));
  const std::string stats = made("run in.ply d.ply --no-provenance --order sweep --stats d.json --pipeline '" + before +
                                     "resort | reneighbor | normals'",
                                 "d.json");
  EXPECT_NE(stats.find("\"sweeps\": 2"), std::string::npos) << stats;
  EXPECT_NE(stats.find("\"certified\": 4000"), std::string::npos) << stats;
  const Result dry = tool("run in.ply e.ply --dry-run --pipeline '" + before + "reneighbor(k=5) | normals'");
  for (const char* words : {"pass 1 of 3", "diagonal of the input", "pass 3 of 3", "the 5 nearest", "carried on"})
    EXPECT_NE(dry.out.find(words), std::string::npos) << words << "\n" << dry.out;
}

/// Returns the types of the positions in the header of a PLY file.
std::string position_types(const std::string& ply) {
  std::string types;
  for (const char* type : {"float", "double"})
    for (const char* axis : {"x", "y", "z"})
      if (ply.find("property " + std::string(type) + " " + axis + "\n") < ply.find("end_header"))
        types += std::string(types.empty() ? "" : " ") + type;
  return types;
}

TEST_F(RunVerb, MovedPositionsAreFloat64UnlessAskedOtherwise) {
  made("run in.ply single.ply --no-provenance --pipeline 'normals | splats | fair' --keep position --positions float32",
       "single.ply");
  const std::string pipeline = "--pipeline 'knn(k=12) | normals | splats | fair | reneighbor | normals'";
  const std::string keep = " --keep position,normal ";
  EXPECT_EQ(position_types(contents(folder_ / "single.ply")), "float float float");
  EXPECT_EQ(position_types(made("normals single.ply still.ply", "still.ply")), "float float float");
  const std::string moved = made("run single.ply a.ply --no-provenance" + keep + pipeline, "a.ply");
  EXPECT_EQ(position_types(moved), "double double double");
  EXPECT_EQ(made("normals a.ply again.ply --no-provenance -k 12 -f", "again.ply"), moved)
      << "normals are those of the positions written";
  for (const char* way : {" --order sweep", " --memory 40M --threads 1"})
    EXPECT_EQ(position_types(made("run single.ply b.ply -f" + keep + pipeline + way, "b.ply")), "double double double");
  EXPECT_EQ(position_types(made("fair single.ply b.ply -k 12 -f --engine reference", "b.ply")), "double double double");
  EXPECT_EQ(position_types(made("fair single.ply c.ply -k 12 --positions float32", "c.ply")), "float float float");
  made("fair single.ply d.txt --no-provenance -k 12 --keep position", "d.txt");
  made("fair single.ply d.ply --no-provenance -k 12 --keep position", "d.ply");
  EXPECT_EQ(made("sort d.txt e.txt --axis x --no-provenance", "e.txt"),
            made("sort d.ply f.txt --axis x --no-provenance", "f.txt"));
  const std::string wide = made("run single.ply h.ply --pipeline normals --positions float64", "h.ply");
  EXPECT_EQ(position_types(wide), "double double double") << "of points that no stage moves, too";
  refused(2, "fair single.ply g.ply --positions half", "--positions: 'half' is not float32 or float64");
  EXPECT_FALSE(exists("g.ply"));
}

TEST_F(RunVerb, NeighborhoodsOfTheirOwnSizeCanBeKeptAndUsedAgain) {
  const std::string adaptive = "'knn(k=40, adaptive=eigenentropy) | ";
  made("run in.ply sizes.ply --pipeline " + adaptive + "neighborhood_size'", "sizes.ply");
  const std::string normals =
      made("run in.ply a.ply --no-provenance --keep normal --pipeline " + adaptive + "normals'", "a.ply");
  EXPECT_EQ(made("normals in.ply b.ply --no-provenance -k 40 --adaptive eigenentropy", "b.ply"), normals);
  EXPECT_NE(made("normals in.ply c.ply --no-provenance -k 40", "c.ply"), normals);
  const std::string again = made("normals sizes.ply d.ply --no-provenance -k 40 --k-from neighbor_count", "d.ply");
  EXPECT_EQ(made("run sizes.ply e.ply --no-provenance --pipeline " + adaptive + "normals'", "e.ply"), again);
  EXPECT_EQ(made("run sizes.ply f.ply --no-provenance --pipeline '[{\"type\": \"knn\", \"k\": 40, \"k_from\": "
                 "\"neighbor_count\"}, "
                 "{\"type\": \"normals\"}]'",
                 "f.ply"),
            again);
  EXPECT_EQ(tool("verify sizes.ply d.ply -k 40 --k-from neighbor_count --sample 500").status, 0);
  EXPECT_EQ(tool("verify in.ply b.ply -k 40 --adaptive eigenentropy --sample 500").status, 0);
  refused(1, "verify in.ply c.ply -k 40 --adaptive eigenentropy --sample 500 -q", "by brute force");
  refused(2, "curvature in.ply g.ply -k 40 --k-from neighbor_count", "the input has no attribute 'neighbor_count'");
  refused(2, "normals in.ply g.ply --k-from neighbor_count", "normals: knn: k_from needs k");
}

TEST_F(RunVerb, AReportShowsTheRunAndItsResult) {
  const std::string page = made("curvature in.ply out.ply --report report.html", "report.html");
  for (const char* words : {"<!doctype html>", "data:image/png;base64,iVBOR", "Working set", "curvature",
                            "Distances of neighbours", "<td>out.ply</td>"}) {
    EXPECT_NE(page.find(words), std::string::npos) << words;
  }
  EXPECT_EQ(made("curvature in.ply again.ply", "again.ply"), contents(folder_ / "out.ply"));
  EXPECT_NE(page.find("<td>command</td><td>pointsweep curvature in.ply out.ply --report report.html</td>"), page.npos);
  EXPECT_NE(page.find("<td>version</td><td>"), page.npos);
  EXPECT_NE(page.find("coloured by rms_curvature"), page.npos) << "what was computed, not the height";
  EXPECT_NE(made("normals in.ply 'an output.ply' --report a.html", "a.html").find("'an output.ply' --report"),
            page.npos);
  EXPECT_NE(contents(folder_ / "a.html").find("coloured by plain"), page.npos);
  refused(1, "curvature in.ply other.ply --report report.html", "report.html");
  EXPECT_FALSE(exists("other.ply"));
  for (const char* name : {"report.pdf", "report", "report.ply"}) {
    refused(2, "curvature in.ply late.ply --report " + std::string(name), "ends with .html");
    EXPECT_FALSE(exists("late.ply")) << "refused before the work";
  }
  made("neighbors in.ply graph.npy --report graph.html", "graph.html");
}

TEST_F(RunVerb, OperatorsAreListedWithEveryOption) {
  const std::string out = tool("operators").out;
  EXPECT_TRUE(out.starts_with("knn: ")) << out;
  for (const OperatorDeclaration& declaration : all_operators()) {
    const auto at = out.find("\n" + declaration.name + ": " + declaration.meaning.substr(0, 20));
    ASSERT_NE(at, std::string::npos) << declaration.name;
    for (const OptionDeclaration& option : declaration.options)
      EXPECT_NE(out.find("\n  " + option.name + " ", at), std::string::npos) << option.name;
    const ChainStage stage = declaration.make(sample_values(declaration), {});
    const std::vector<Attribute> made = contract_of(stage).makes;
    const bool makes = !made.empty() && made.front().name != selection_attribute().name && !declaration.makes_named;
    EXPECT_EQ(tool("operators " + declaration.name).out.find("\n  makes ") != std::string::npos, makes);
    EXPECT_NE(out.find(tool("operators " + declaration.name).out), std::string::npos);
  }
  EXPECT_TRUE(out.starts_with(tool("operators knn").out));
  refused(2, "operators nromals", "the nearest is 'normals'");
}

}  // namespace
}  // namespace pointsweep
