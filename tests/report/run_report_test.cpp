// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "pointsweep/program/report.h"

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
  with.picture = Rendering{
      .picture = {20, 16, std::vector<Rgb>(320)}, .color = "k1", .is_number = true, .lo = 0.5, .hi = 2, .drawn = 12345};
  with.statistics.neighbor_distances = {{0, 1e-200, 7, 0}, {0.5, 0.6, 100, 0}, {0.6, 0.7, 5, 90}};
  const std::string page = report_of(with);
  says(page, "data:image/png;base64,iVBOR");
  says(page, "coloured by k1: violet 0.5 to yellow 2");
  EXPECT_EQ(page.find("Drawn are"), page.npos);
  says(page, "Distances of neighbours");
  says(page, "<td>duplicate points</td><td>7</td>");
}

RunSummary complete() {
  RunSummary s = summary();
  s.crs = "EPSG:26910 (NAD83 / UTM zone 10N)", s.unit = "m";
  s.statistics.points_written = 12000, s.statistics.degenerate = 7, s.statistics.order_seconds = 1;
  s.statistics.degenerate_results = {{"normals", 7, {}}};
  s.picture = Rendering{
      .picture = {20, 16, std::vector<Rgb>(320)}, .color = "k1", .is_number = true, .lo = 0.5, .hi = 2, .drawn = 3000};
  s.drawing_seconds = 0.25;
  s.made = {{.name = "k1",
             .unit = "1/m",
             .values = 3000,
             .undefined = 2,
             .quantiles = {0, 1, 2, 3, 4, 5, 6},
             .edges = {0, 3, 6},
             .counts = {1000, 1998}}};
  return s;
}

TEST(RunReport, TellsTheResultBeforeTheTimeAndTheTimeBeforeTheEngine) {
  const std::string page = report_of(complete());
  std::size_t at = 0;
  for (const char* words : {"<td>input</td><td>in.ply</td>",
                            "<td>output</td><td>out.ply</td>",
                            "<td>points read</td><td>12345</td>",
                            "<td>points written</td><td>12000</td>",
                            "EPSG:26910",
                            "<td>unit of lengths</td><td>m</td>",
                            "<td>made</td><td>k1</td>",
                            "something is odd",
                            "data:image/png",
                            "What was made",
                            "k1 (1/m)",
                            "5 % 1, 25 % 2, median 3, 75 % 4, 95 % 5, greatest 6; 2 undefined",
                            "Counts",
                            "<td>left out by the pipeline</td><td>345</td>",
                            "<td>degenerate in normals</td><td>7</td>",
                            "<h2>Time</h2>",
                            "ordering (wall)",
                            "drawing this page",
                            "<h2>Engine</h2>",
                            "Working set",
                            "certified"}) {
    const std::size_t found = page.find(words, at);
    ASSERT_NE(found, page.npos) << words;
    at = found;
  }
  says(page, "Drawn are 3000 of 12000 points");
  says(page, "Of 3000 points, evenly chosen.");
}

TEST(ValueSummaries, CountWhatIsThere) {
  Schema schema;
  for (const char* name : {"x", "curve", "label"}) schema.append(name, Type::f32);
  std::vector<float> values;
  for (int i = 0; i <= 1000; ++i) {
    const float curve = i == 500 ? NAN : static_cast<float>(i) / 1000;
    values.insert(values.end(), {0, curve, static_cast<float>(i % 3)});
  }
  const std::vector<std::string> fields = {"label", "curve"};
  const auto made = value_summaries(schema, std::as_bytes(std::span(values)), fields, "m");
  ASSERT_EQ(made.size(), 2u);
  EXPECT_EQ(made[0].name, "curve");
  EXPECT_EQ(made[0].values, 1001u);
  EXPECT_EQ(made[0].undefined, 1u);
  const float expected[] = {0, 0.049F, 0.249F, 0.499F, 0.75F, 0.95F, 1};  // ranks 0, 49, 249, 499, 749, 949, 999
  for (std::size_t p = 0; p < 7; ++p) EXPECT_EQ(made[0].quantiles[p], expected[p]) << p;
  EXPECT_EQ(std::accumulate(made[0].counts.begin(), made[0].counts.end(), 0.0), 1000);
  EXPECT_EQ(made[1].unit, "") << "no unit is known for it";
  EXPECT_EQ(made[1].counts, (std::vector<double>{334, 334, 333})) << "a bin for each whole number";
  EXPECT_EQ(made[1].edges, (std::vector<double>{-0.5, 0.5, 1.5, 2.5}));
}

TEST(ValueSummaries, OfEqualOrNoValuesHaveNoFold) {
  Schema schema;
  schema.append("a", Type::f64);
  const std::vector<std::string> fields = {"a"};
  const auto of = [&](std::vector<double> values) {
    return value_summaries(schema, std::as_bytes(std::span(values)), fields, "m").front();
  };
  EXPECT_TRUE(of({}).counts.empty());
  EXPECT_TRUE(of({NAN, INFINITY}).counts.empty());
  EXPECT_EQ(of({NAN, INFINITY}).undefined, 2u);
  for (const double same : {0.0, 0.25, 1e300, -7.0}) {
    const ValueSummary summary = of({same, same});
    EXPECT_EQ(std::accumulate(summary.counts.begin(), summary.counts.end(), 0.0), 2) << same;
    EXPECT_LT(summary.edges.front(), summary.edges.back()) << same;
  }
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
  EXPECT_EQ(of({"ground"}, {}), "") << "of an input without classes, whose output has none";
  EXPECT_EQ(of({"fair"}, {}), "");
  EXPECT_EQ(of({"neighbors"}, {"neighbor_0", "distance_0"}), "");
  EXPECT_EQ(of({}, {}), "");
}

TEST(MadeNumbers, AreThoseThatTheInputHasNotOrThatAreMadeAgain) {
  const Schema input = with_fields({"x", "y", "z", "age", "classification"});
  const Schema output = with_fields({"x", "y", "z", "age", "classification", "height"});
  const std::vector<std::string> ground = {"ground", "height"}, own = {"own"};
  EXPECT_EQ(made_numbers(ground, input, output), (std::vector<std::string>{"classification", "height"}));
  EXPECT_EQ(pictured_attribute(std::span(ground).first(1), input, output), "classification");
  EXPECT_EQ(made_numbers(own, input, output), (std::vector<std::string>{"height"}));
}

TEST(RunReport, ARunThatDidNothingStillHasAPage) {
  const std::string page = report_of(RunSummary{});
  EXPECT_TRUE(page.ends_with("</html>\n"));
  EXPECT_EQ(page.find("nan"), page.npos);
}

}  // namespace
}  // namespace pointsweep
