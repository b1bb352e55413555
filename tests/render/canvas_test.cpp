// SPDX-License-Identifier: MIT
#include "pointsweep/render/canvas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pointsweep {
namespace {

constexpr Rgb kWhite{255, 255, 255}, kRed{255, 0, 0}, kBlue{0, 0, 255};

std::size_t count_of(const Picture& picture, Rgb color) {
  return static_cast<std::size_t>(std::count(picture.pixels.begin(), picture.pixels.end(), color));
}

Rgb pixel(const Picture& picture, std::size_t x, std::size_t y) { return picture.pixels[y * picture.width + x]; }

TEST(Canvas, AnEllipseCoversItsArea) {
  for (const double angle : {0.0, 0.4, 1.1}) {
    Canvas canvas(400, 300, 1, kWhite);
    const double c = std::cos(angle), s = std::sin(angle);
    canvas.draw({{200, 150, 0}, {40 * c, 40 * s, 0}, {-15 * s, 15 * c, 0}}, kRed);
    EXPECT_NEAR(static_cast<double>(count_of(canvas.picture(), kRed)), std::numbers::pi * 40 * 15, 20);
  }
}

TEST(Canvas, AnEllipseEndsWhereItsAxesEnd) {
  Canvas canvas(400, 300, 1, kWhite);
  canvas.draw({{200, 150, 0}, {40, 0, 0}, {0, 20, 0}}, kRed);
  const Picture picture = canvas.picture();
  EXPECT_EQ(pixel(picture, 239, 150), kRed);
  EXPECT_EQ(pixel(picture, 240, 150), kWhite);
  EXPECT_EQ(pixel(picture, 200, 169), kRed);
  EXPECT_EQ(pixel(picture, 200, 170), kWhite);
  EXPECT_EQ(pixel(picture, 232, 166), kWhite);
}

TEST(Canvas, TheNearerOneIsSeenWhicheverComesFirst) {
  for (const bool red_first : {true, false}) {
    Canvas canvas(64, 64, 1, kWhite);
    const auto draw = [&](bool red) {
      canvas.draw({{32, 32, red ? 2.0 : 1.0}, {5, 0, 0}, {0, 5, 0}}, red ? kRed : kBlue);
    };
    draw(red_first);
    draw(!red_first);
    EXPECT_EQ(pixel(canvas.picture(), 32, 32), kRed);
    EXPECT_EQ(count_of(canvas.picture(), kBlue), 0u);
  }
}

TEST(Canvas, EllipsesThatCrossHideEachOtherAlongALine) {
  Canvas canvas(400, 400, 1, kWhite);
  canvas.draw({{200, 200, 0}, {40, 0, 30}, {0, 40, 0}}, kRed);
  canvas.draw({{200, 200, 0}, {40, 0, -30}, {0, 40, 0}}, kBlue);
  const Picture picture = canvas.picture();
  for (const std::size_t y : {180u, 200u, 220u}) {
    EXPECT_EQ(pixel(picture, 190, y), kBlue);
    EXPECT_EQ(pixel(picture, 210, y), kRed);
  }
  EXPECT_NEAR(static_cast<double>(count_of(picture, kRed)), static_cast<double>(count_of(picture, kBlue)), 90);
}

TEST(Canvas, WhatIsSmallerThanASampleIsStillASample) {
  Canvas canvas(16, 16, 1, kWhite);
  canvas.draw({{3.7, 4.2, 0}, {1e-3, 0, 0}, {0, 1e-3, 0}}, kRed);
  canvas.draw({{8.5, 9.5, 0}, {0, 2, 0}, {0, 0, 2}}, kBlue);
  EXPECT_EQ(pixel(canvas.picture(), 3, 4), kRed);
  EXPECT_EQ(pixel(canvas.picture(), 8, 9), kBlue);
  EXPECT_EQ(count_of(canvas.picture(), kWhite), 16u * 16 - 2);
}

TEST(Canvas, WhatLiesOutsideIsCutOff) {
  Canvas canvas(80, 80, 1, kWhite);
  for (const double x : {-100.0, 180.0, 1e300, -1e300, std::nan("")})
    canvas.draw({{x, 40, 0}, {9, 0, 0}, {0, 9, 0}}, kRed);
  EXPECT_EQ(count_of(canvas.picture(), kWhite), 6400u);
  canvas.draw({{0, 40, 0}, {8, 0, 0}, {0, 8, 0}}, kRed);
  EXPECT_NEAR(static_cast<double>(count_of(canvas.picture(), kRed)), std::numbers::pi * 64 / 2, 6);
}

TEST(Canvas, NoEllipseFillsThePicture) {
  Canvas canvas(160, 160, 1, kWhite);
  canvas.draw({{80, 80, 0}, {1e9, 0, 0}, {0, 1e9, 0}}, kRed);
  EXPECT_NEAR(static_cast<double>(count_of(canvas.picture(), kRed)), std::numbers::pi * 20 * 20, 20);
}

TEST(Canvas, PixelsAreTheMeanOfTheirSamples) {
  Canvas canvas(16, 16, 2, {0, 0, 0});
  canvas.draw({{4.25, 4.25, 0}, {}, {}}, {200, 100, 40});
  EXPECT_EQ(pixel(canvas.picture(), 4, 4), (Rgb{50, 25, 10}));
}

TEST(Canvas, LightFromDepthDarkensWhatLiesBehindAStep) {
  Canvas canvas(64, 64, 1, kWhite);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) canvas.draw({{x + 0.5, y + 0.5, x < 32 ? 0.0 : 30.0}, {}, {}}, {100, 100, 100});
  }
  canvas.shade_by_depth();
  EXPECT_EQ(pixel(canvas.picture(), 10, 30), (Rgb{100, 100, 100}));
  EXPECT_EQ(pixel(canvas.picture(), 50, 30), (Rgb{100, 100, 100}));
  EXPECT_LT(pixel(canvas.picture(), 31, 30).red, 60);
  EXPECT_EQ(pixel(canvas.picture(), 32, 30), (Rgb{100, 100, 100}));
}

}  // namespace
}  // namespace pointsweep
