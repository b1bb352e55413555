// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class ReferenceEngine : public Tool {
 protected:
  ReferenceEngine() { EXPECT_EQ(tool("generate sphere in.ply -n 3000").status, 0); }
};

TEST_F(ReferenceEngine, WritesWhatTheEngineWritesWhereNeighborhoodsAreComplete) {
  EXPECT_EQ(made("fair in.ply a.ply --no-provenance -k 60 --radius 0.15 --f 3", "a.ply"),
            made("fair in.ply h.ply --no-provenance -k 60 --radius 0.15 --f 3 --engine reference", "h.ply"));
  EXPECT_EQ(made("curvature in.ply b.ply --no-provenance -k 60 --radius 0.15", "b.ply"),
            made("curvature in.ply c.ply --no-provenance -k 60 --radius 0.15 --engine reference", "c.ply"));
  EXPECT_EQ(made("normals in.ply d.ply --no-provenance --radius 0.15 --order sweep", "d.ply"),
            made("normals in.ply e.ply --no-provenance --radius 0.15 --order sweep --engine reference", "e.ply"));
  EXPECT_EQ(made("neighbors in.ply f.npy -k 60 --radius 0.15", "f.npy"),
            made("neighbors in.ply g.npy -k 60 --radius 0.15 --engine reference", "g.npy"));
  EXPECT_EQ(made("normals in.ply k.ply --no-provenance -k 60 --radius 0.15 --adaptive eigenentropy", "k.ply"),
            made("normals in.ply l.ply --no-provenance -k 60 --radius 0.15 --adaptive eigenentropy --engine reference",
                 "l.ply"));
  const std::string twice = "--pipeline 'knn(k=60, radius=0.15) | normals | splats | fair | reneighbor | normals'";
  EXPECT_EQ(made("run in.ply i.ply --no-provenance " + twice, "i.ply"),
            made("run in.ply j.ply --no-provenance --engine reference " + twice, "j.ply"));
}

TEST_F(ReferenceEngine, StatisticsHoldCountsAndBuffers) {
  const std::string run = "run in.ply out.ply --force --pipeline 'normals | curvature | splats' --stats ";
  const auto json = nlohmann::json::parse(made(run + "a.json --engine reference", "a.json"));
  const auto& reference = json["reference"];
  EXPECT_EQ(reference["complete"].get<int>() + reference["incomplete"].get<int>(), 3000);
  ASSERT_EQ(json["buffers"].size(), 6u);
  EXPECT_EQ(json["buffers"][3]["operator"], "curvature");
  EXPECT_EQ(json["buffers"][3]["series"].size(), 1000u);
  EXPECT_EQ(json["buffers"][3]["series"][999][0], 3000);
  const auto exact = nlohmann::json::parse(made(run + "b.json", "b.json"));
  EXPECT_FALSE(exact.contains("reference"));
  EXPECT_EQ(exact["buffers"][1]["operator"], "curvature, splats");
}

TEST_F(ReferenceEngine, WhatItCannotDoIsSaid) {
  refused(2, "normals in.ply out.ply --engine paper", "--engine: 'paper' is not exact or reference");
  refused(2, "curvature in.ply out.ply --engine reference --dry-run", "leave out --dry-run or --engine reference");
  refused(2, "sort in.ply out.ply --engine reference", "--engine");
  refused(2, "normals in.ply out.ply --half-way-states states.npy --engine reference", "Half-way states");
  refused(2, "normals in.ply out.ply --resume checkpoints --engine reference", "cannot be resumed");
  EXPECT_FALSE(exists("out.ply"));
  EXPECT_FALSE(exists("checkpoints"));
}

/// Returns the number of rows, of `bytes` bytes each, that differ between two .npy files.
int differing_rows(const std::string& a, const std::string& b, std::size_t bytes) {
  const std::size_t header = a.size() % bytes == 0 ? bytes : a.size() % bytes;
  EXPECT_EQ(a.size(), b.size());
  int count = 0;
  for (std::size_t i = header; i + bytes <= a.size(); i += bytes) count += a.compare(i, bytes, b, i, bytes) != 0;
  return count;
}

TEST_F(ReferenceEngine, StatisticsCountTheListsThatDifferInEitherOrder) {
  EXPECT_EQ(tool("generate tls scan.ply -n 4000").status, 0);
  for (const std::string& limits : {std::string("-k 8"), std::string("-k 8 --radius 3")}) {
    const std::string exact = made("neighbors scan.ply e.npy --force " + limits, "e.npy");
    const std::string ours =
        made("neighbors scan.ply r.npy --force --engine reference --stats a.json " + limits, "r.npy");
    const int differing = differing_rows(exact, ours, 8 * sizeof(std::uint32_t));
    EXPECT_EQ(nlohmann::json::parse(contents(folder_ / "a.json"))["reference"]["incomplete"], differing) << limits;
    made("normals scan.ply n.ply --force --engine reference --order sweep --stats b.json " + limits, "n.ply");
    EXPECT_EQ(nlohmann::json::parse(contents(folder_ / "b.json"))["reference"]["incomplete"], differing) << limits;
  }
}

TEST_F(ReferenceEngine, TakesJsonPipelinesSeveralInputsAndOtherFormats) {
  EXPECT_EQ(tool("generate statue more.ply -n 3000").status, 0);
  write("chain.json",
        R"({"pipeline": [{"type": "knn", "radius": 0.15, "radius_from": "nz"},
     {"type": "normals"}, {"type": "splats"}, {"type": "fair"}]})");
  const auto output = [&](const std::string& engine, const std::string& order, const std::string& name) {
    return made("run in.ply more.ply --no-provenance --pipeline chain.json --engine " + engine + " --order " + order +
                    " -o " + name,
                name);
  };
  for (const char* order : {"input", "sweep"}) {
    EXPECT_EQ(output("exact", order, std::string("a") + order + ".las"),
              output("reference", order, std::string("b") + order + ".las"));
    EXPECT_EQ(output("exact", order, std::string("a") + order + ".txt"),
              output("reference", order, std::string("b") + order + ".txt"));
  }
}

TEST_F(ReferenceEngine, MakesReports) {
  EXPECT_EQ(tool("normals in.ply out.ply --engine reference --report page.html").status, 0);
  EXPECT_TRUE(exists("page.html"));
}

}  // namespace
}  // namespace pointsweep
