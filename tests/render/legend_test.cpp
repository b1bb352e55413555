// SPDX-License-Identifier: MIT
#include "pointsweep/render/legend.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pointsweep/colors/color_map.h"
#include "pointsweep/program/declaration.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {
namespace {

constexpr Rgb kPaper{255, 255, 255}, kBlack{0, 0, 0};

Picture blank(unsigned width, unsigned height) {
  return {width, height, std::vector<Rgb>(std::size_t{width} * height, kPaper)};
}

Rgb at(const Picture& p, unsigned x, unsigned y) { return p.pixels[std::size_t{y} * p.width + x]; }

std::size_t ink(const Picture& p) {
  return p.pixels.size() - static_cast<std::size_t>(std::count(p.pixels.begin(), p.pixels.end(), kPaper));
}

TEST(Lettering, EveryCharacterIsDrawnInsideItsWidthAndLooksDifferent) {
  const Lettering letters(24, kBlack);
  std::vector<std::vector<Rgb>> drawn;
  for (char c = '!'; c <= '~'; ++c) {
    Picture picture = blank(80, 60);
    letters.draw(picture, 20, 40, std::string(1, c));
    EXPECT_GT(ink(picture), 8u) << c;
    const double right = 20 + letters.width(std::string(1, c));
    for (unsigned y = 0; y < 60; ++y) {
      for (unsigned x = 0; x < 80; ++x) {
        if (at(picture, x, y) == kPaper) continue;
        ASSERT_GE(x, 18u) << c;
        ASSERT_LE(x, right + 2) << c;
        ASSERT_GE(y, 40 - 28 - 4u) << c;
        ASSERT_LE(y, 40 + 10u) << c;
      }
    }
    drawn.push_back(picture.pixels);
  }
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    for (std::size_t j = i + 1; j < drawn.size(); ++j) {
      const bool alike = (i + '!' == '0' && j + '!' == 'O');  // the same shape in this font
      EXPECT_EQ(drawn[i] == drawn[j], alike) << char('!' + i) << char('!' + j);
    }
  }
}

TEST(Lettering, EdgesAreSmooth) {
  Picture picture = blank(60, 40);
  Lettering(20, kBlack).draw(picture, 5, 30, "A");
  const auto grey =
      std::count_if(picture.pixels.begin(), picture.pixels.end(), [](Rgb c) { return c.red > 30 && c.red < 225; });
  EXPECT_GT(grey, 20);
}

TEST(Lettering, TextIsCutOffAtTheEdges) {
  Picture picture = blank(20, 20);
  Lettering letters(30, kBlack);
  letters.draw(picture, -10, 5, "MMMM");
  letters.draw(picture, 15, 200, "MMMM");
  EXPECT_GT(ink(picture), 0u);
  EXPECT_EQ(letters.width(""), 0);
  EXPECT_GT(letters.width("MM"), 1.9 * letters.width("M"));
}

Legend bar(double lo, double hi) {
  Legend legend;
  legend.title = "height";
  legend.unit = "m";
  legend.is_bar = true;
  legend.lo = lo;
  legend.hi = hi;
  return legend;
}

TEST(Legend, ABarRunsFromTheDarkEndBelowToTheBrightEndAbove) {
  const LegendColumn column(bar(0, 10), 800, 600, kPaper);
  ASSERT_GT(column.width(), 50u);
  Picture picture = blank(800, 600);
  column.draw(picture);
  std::vector<Rgb> column_of_bar;
  const auto x = static_cast<unsigned>(800 - column.width() + 24);
  for (unsigned y = 0; y < 600; ++y) column_of_bar.push_back(at(picture, x, y));
  const auto lightness = [](Rgb c) { return 0.2126 * c.red + 0.7152 * c.green + 0.0722 * c.blue; };
  const auto yellow = [](Rgb c) { return c.red > 240 && c.green > 220 && c.blue < 60; };
  const auto top = std::find_if(column_of_bar.begin(), column_of_bar.end(), yellow);
  ASSERT_NE(top, column_of_bar.end());
  for (auto y = top + 1; y < column_of_bar.end() && *y != kPaper; ++y)
    EXPECT_LE(lightness(*y), lightness(*(y - 1)) + 1);
  for (unsigned y = 0; y < 600; ++y) ASSERT_EQ(at(picture, 10, y), kPaper) << "outside of the column";
}

TEST(Legend, EntriesHaveTheirColors) {
  Legend legend;
  legend.title = "classification";
  legend.entries = {{Rgb{1, 2, 3}, "2 Ground"}, {Rgb{200, 100, 50}, "6 Building"}};
  const LegendColumn column(legend, 800, 600, kPaper);
  Picture picture = blank(800, 600);
  column.draw(picture);
  for (const auto& [color, name] : legend.entries)
    EXPECT_GT(std::count(picture.pixels.begin(), picture.pixels.end(), color), 50) << name;
}

TEST(Legend, TakesNoRoomWhereThereIsNoneOrNothingToSay) {
  EXPECT_EQ(LegendColumn(Legend{}, 800, 600, kPaper).width(), 0u);
  EXPECT_EQ(LegendColumn(bar(0, 1), 200, 150, kPaper).width(), 0u);
  EXPECT_EQ(LegendColumn(bar(0, 1), 3000, 60, kPaper).width(), 0u);
  Picture picture = blank(200, 150);
  LegendColumn(bar(0, 1), 200, 150, kPaper).draw(picture);
  EXPECT_EQ(ink(picture), 0u);
}

TEST(Legend, WritesLightOnDark) {
  Picture picture{800, 600, std::vector<Rgb>(480000, kBlack)};
  LegendColumn(bar(0, 1), 800, 600, kBlack).draw(picture);
  EXPECT_GT(
      std::count_if(picture.pixels.begin(), picture.pixels.end(), [](Rgb c) { return c.red > 180 && c.blue > 180; }),
      50);
}

TEST(Legend, AnyRangeCanBeDrawn) {
  for (const auto& [lo, hi] : std::vector<std::pair<double, double>>{
           {5, 5}, {-1e30, 1e30}, {1e-12, 2e-12}, {4e6, 4e6 + 1}, {0, 0}, {NAN, NAN}, {-INFINITY, INFINITY}}) {
    const LegendColumn column(bar(lo, hi), 1200, 900, kPaper);
    Picture picture = blank(1200, 900);
    column.draw(picture);
    EXPECT_GT(ink(picture), 100u) << lo << " " << hi;
  }
}

TEST(AttributeUnit, KnowsWhatNamesSay) {
  EXPECT_EQ(unit_of_attribute("height", "m"), "m");
  EXPECT_EQ(unit_of_attribute("rms_curvature", "m"), "1/m");
  EXPECT_EQ(unit_of_attribute("rms_curvature", ""), "1/file unit");
  EXPECT_EQ(unit_of_attribute("gaussian_curvature", "ft"), "1/ft^2");
  EXPECT_EQ(unit_of_attribute("height", ""), "file units");
  EXPECT_EQ(unit_of_attribute("intensity", "m"), "");
}

TEST(AttributeUnit, IsThatOfEveryLengthThatAnOperatorMakes) {
  std::size_t lengths = 0;
  for (const OperatorDeclaration& declaration : all_operators())
    for (const Attribute& a : contract_of(declaration).makes) {
      if (a.fields.size() != 1 || a.unit != "length") continue;
      EXPECT_EQ(unit_of_attribute(a.name, "m"), "m") << a.name;
      ++lengths;
    }
  EXPECT_GT(lengths, 10u);
}

}  // namespace
}  // namespace pointsweep
