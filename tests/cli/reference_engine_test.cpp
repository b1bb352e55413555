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
  const std::string twice = "--pipeline 'knn(k=60, radius=0.15) | normals | splats | fair | reneighbor | normals'";
  EXPECT_EQ(made("run in.ply i.ply --no-provenance " + twice, "i.ply"),
            made("run in.ply j.ply --no-provenance --engine reference " + twice, "j.ply"));
}

TEST_F(ReferenceEngine, StatisticsHoldCountsAndBuffers) {
  const std::string run = "run in.ply out.ply --force --pipeline 'normals | curvature | splats' --stats ";
  const auto json = nlohmann::json::parse(made(run + "a.json --engine reference", "a.json"));
  const auto& reference = json["reference"];
  EXPECT_EQ(reference["complete"].get<int>() + reference["incomplete"].get<int>(), 3000);
  EXPECT_EQ(reference["overlooked"].get<int>() + reference["unknown"].get<int>(), reference["incomplete"].get<int>());
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
  refused(2, "normals in.ply out.ply -k 20 --adaptive eigenentropy --engine reference", "leave out --engine reference");
  refused(2, "normals in.ply out.ply --half-way-states states.npy --engine reference", "Half-way states");
  EXPECT_FALSE(exists("out.ply"));
}

}  // namespace
}  // namespace pointsweep
