// SPDX-License-Identifier: MIT
#include "pointsweep/report/run_report.h"

#include <gtest/gtest.h>

#include "pointsweep/report/pictured_attribute.h"

namespace pointsweep {
namespace {

RunSummary summary() {
  RunSummary summary;
  summary.title = "a <scan>";
  summary.inputs = "in.ply";
  summary.output = "out.ply";
  summary.command = "pointsweep normals in.ply 'out.ply'";
  summary.version = "pointsweep 1.2.3";
  Statistics& s = summary.statistics;
  s.points = 12345;
  s.k = 8;
  s.series = {{5000, 300}, {12345, 100}};
  s.operator_seconds = {{"normals", 1.5}, {"curvature", 2.5}};
  s.warnings = {"something is odd."};
  return summary;
}

void says(const std::string& page, const std::string& words) {
  EXPECT_NE(page.find(words), std::string::npos) << words;
}

TEST(RunReport, SaysWhatTheStatisticsSay) {
  const std::string page = report_of(summary());
  for (const char* words :
       {"a &lt;scan&gt;", "in.ply", "out.ply", "12345", "Working set", "normals", "2.5 s", "Warning: something is odd.",
        "<td>command</td><td>pointsweep normals in.ply 'out.ply'</td>", "<td>version</td><td>pointsweep 1.2.3</td>"}) {
    says(page, words);
  }
  EXPECT_EQ(page.find("<img"), page.npos);
  EXPECT_EQ(page.find("Distances of neighbours"), page.npos);
}

TEST(RunReport, ShowsThePictureAndTheDistancesWhereThereAreSome) {
  RunSummary with = summary();
  with.picture = Rendering{{20, 16, std::vector<Rgb>(320)}, "k1", true, 0.5, 2, {}, {}};
  with.statistics.neighbor_distances = {{0, 1e-200, 7, 0}, {0.5, 0.6, 100, 0}, {0.6, 0.7, 5, 90}};
  const std::string page = report_of(with);
  says(page, "data:image/png;base64,iVBOR");
  says(page, "coloured by k1: violet 0.5 to yellow 2");
  says(page, "Distances of neighbours");
  says(page, "<td>duplicate points</td><td>7</td>");
}

Schema with_fields(std::vector<std::string> names) {
  Schema schema;
  for (const auto& name : names) schema.append(name, Type::f32);
  return schema;
}

TEST(PicturedAttribute, IsWhatTheLastOperatorComputed) {
  const Schema input = with_fields({"x", "y", "z", "age"});
  const auto of = [&](std::vector<std::string> operators, std::vector<std::string> made) {
    Schema output = input;
    for (const auto& name : made) output.append(name, Type::f32);
    return pictured_attribute(operators, input, output);
  };
  EXPECT_EQ(of({"normals"}, {"nx", "ny", "nz"}), "plain");
  EXPECT_EQ(of({"normals", "curvature"}, {"nx", "ny", "nz", "k1", "rms_curvature"}), "rms_curvature");
  EXPECT_EQ(of({"normals", "curvature"}, {"nx", "ny", "nz", "gaussian_curvature"}), "gaussian_curvature");
  EXPECT_EQ(of({"normals", "splats"}, {"nx", "ny", "nz", "splat_x", "splat_length"}), "plain");
  EXPECT_EQ(of({"normals", "curvature"}, {"nx", "ny", "nz"}), "plain") << "where only normals are kept";
  EXPECT_EQ(of({"normals", "fair", "reneighbor", "normals"}, {"nx", "ny", "nz"}), "plain");
  EXPECT_EQ(of({"neighborhood_size"}, {"neighbor_count", "neighbor_radius"}), "neighbor_count");
  EXPECT_EQ(of({"normals", "roughness"}, {"nx", "ny", "nz", "roughness"}), "roughness");
  EXPECT_EQ(of({"fair"}, {}), "");
  EXPECT_EQ(of({"neighbors"}, {"neighbor_0", "distance_0"}), "");
  EXPECT_EQ(of({}, {}), "");
}

TEST(RunReport, ARunThatDidNothingStillHasAPage) {
  const std::string page = report_of(RunSummary{});
  EXPECT_TRUE(page.ends_with("</html>\n"));
  EXPECT_EQ(page.find("nan"), page.npos);
}

}  // namespace
}  // namespace pointsweep
