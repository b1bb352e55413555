// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "pointsweep/report/page.h"

namespace pointsweep {
namespace {

std::size_t count_of(const std::string &text, const std::string &part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++count;
  return count;
}

std::vector<double> values_of(const std::vector<Tick> &ticks) {
  std::vector<double> values;
  for (const Tick &tick : ticks) values.push_back(tick.value);
  return values;
}

TEST(Scale, PlacesEndsAtEnds) {
  const Scale linear(10, 30, 100, 0), logarithmic(0.01, 100, 0, 40, true);
  EXPECT_DOUBLE_EQ(linear.place(10), 100);
  EXPECT_DOUBLE_EQ(linear.place(15), 75);
  EXPECT_DOUBLE_EQ(logarithmic.place(0.1), 10);
  EXPECT_DOUBLE_EQ(logarithmic.place(100), 40);
}

TEST(Scale, TicksAreRound) {
  EXPECT_EQ(values_of(Scale(0, 1, 0, 1).ticks(5)), (std::vector<double>{0, 0.2, 0.4, 0.6000000000000001, 0.8, 1}));
  EXPECT_EQ(values_of(Scale(0, 70, 0, 1).ticks(4)), (std::vector<double>{0, 20, 40, 60}));
  EXPECT_EQ(values_of(Scale(0.5, 30, 0, 1, true).ticks(8)), (std::vector<double>{0.5, 1, 2, 5, 10, 20}));
  EXPECT_EQ(values_of(Scale(1, 1e6, 0, 1, true).ticks(8)), (std::vector<double>{1, 10, 100, 1000, 10000, 100000, 1e6}));
}

TEST(Scale, AnEmptyRangeStillHasTicks) { EXPECT_FALSE(Scale(0, 0, 0, 1).ticks(5).empty()); }

TEST(Scale, NumbersAreShort) {
  EXPECT_EQ(short_number(0), "0");
  EXPECT_EQ(short_number(20000000), "20M");
  EXPECT_EQ(short_number(1500), "1.5k");
  EXPECT_EQ(short_number(0.25), "0.25");
  EXPECT_EQ(short_number(3.21e-5), "3.21e-05");
}

TEST(Plot, ALineHasAPlaceForEachPoint) {
  const std::string svg = line_plot({"t", "x", "y"}, {{"a", {{0, 0}, {50, 1}, {NAN, 3}, {100, 2}}}, {"b", {{0, 1}}}});
  std::smatch line;
  ASSERT_TRUE(std::regex_search(svg, line, std::regex("class=\"line\"[^>]* d=\"([^\"]*)\"")));
  const std::string path = line[1];
  EXPECT_EQ(count_of(path, "M") + count_of(path, "L"), 3u);
  EXPECT_EQ(count_of(svg, "class=\"line\""), 2u);
  EXPECT_NE(svg.find(">b</text>"), svg.npos);
}

TEST(Plot, BarsAreAsLongAsTheirValues) {
  const std::string svg = bar_plot("t", {{"one", 1, "1 s"}, {"four", 4, "4 s"}});
  std::vector<double> widths;
  const std::regex rect("<rect[^>]* width=\"([0-9.]+)\"");
  for (std::sregex_iterator it(svg.begin(), svg.end(), rect), end; it != end; ++it)
    widths.push_back(std::stod((*it)[1]));
  ASSERT_EQ(widths.size(), 2u);
  EXPECT_NEAR(widths[1], 4 * widths[0], 0.5);
}

TEST(Plot, AHistogramGoesUpAndDownOncePerBin) {
  const std::string svg = histogram_plot({"t", "x", "y"}, {1, 2, 4, 8}, {{"a", {5, 0, 2}}});
  std::smatch area;
  ASSERT_TRUE(std::regex_search(svg, area, std::regex("class=\"area\"[^>]* d=\"([^\"]*)\"")));
  EXPECT_EQ(count_of(area[1], "H"), 3u);
  EXPECT_EQ(histogram_plot({"t", "x", "y"}, {}, {}), "");
}

TEST(Plot, NothingBreaksOutOfThePage) {
  EXPECT_EQ(escaped("<a href=\"x\">&"), "&lt;a href=&quot;x&quot;&gt;&amp;");
  Page page("<script>");
  page.paragraph("<b>");
  page.table({{"<i>", "<u>"}});
  for (const char *tag : {"<script>", "<b>", "<i>", "<u>"}) EXPECT_EQ(page.html().find(tag), std::string::npos) << tag;
}

TEST(Page, Base64IsThatOfTheStandard) {
  const auto code = [](std::string_view text) { return to_base64(std::as_bytes(std::span(text))); };
  EXPECT_EQ(code(""), "");
  EXPECT_EQ(code("f"), "Zg==");
  EXPECT_EQ(code("fo"), "Zm8=");
  EXPECT_EQ(code("foo"), "Zm9v");
  EXPECT_EQ(code("foobar"), "Zm9vYmFy");
}

TEST(Page, LoadsNothing) {
  Page page("title");
  page.plot(bar_plot("t", {{"one", 1, "1 s"}}));
  page.picture(std::as_bytes(std::span("png", 3)), "caption");
  const std::string html = page.html();
  EXPECT_EQ(html.find("http"), html.npos);
  EXPECT_EQ(html.find("<script"), html.npos);
  EXPECT_EQ(html.find("<link"), html.npos);
  EXPECT_NE(html.find("data:image/png;base64,cG5n"), html.npos);
}

}  // namespace
}  // namespace pointsweep
