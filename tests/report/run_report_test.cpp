// SPDX-License-Identifier: MIT
#include "pointsweep/report/run_report.h"

#include <gtest/gtest.h>

namespace pointsweep {
namespace {

RunSummary summary() {
  RunSummary summary;
  summary.title = "a <scan>";
  summary.inputs = "in.ply";
  summary.output = "out.ply";
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
  for (const char* words : {"a &lt;scan&gt;", "in.ply", "out.ply", "12345", "Working set", "normals", "2.5 s",
                            "Warning: something is odd."}) {
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
  says(page, "<td>points with an equal one</td><td>7</td>");
}

TEST(RunReport, ARunThatDidNothingStillHasAPage) {
  const std::string page = report_of(RunSummary{});
  EXPECT_TRUE(page.ends_with("</html>\n"));
  EXPECT_EQ(page.find("nan"), page.npos);
}

}  // namespace
}  // namespace pointsweep
