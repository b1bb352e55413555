// SPDX-License-Identifier: MIT
#include "pointsweep/program/render.h"

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "pointsweep/colors/color_map.h"
#include "pointsweep/error.h"
#include "pointsweep/reader.h"
#include "pointsweep/render/canvas.h"
#include "pointsweep/writer.h"

namespace pointsweep {
namespace {

constexpr Rgb kWhitePixel{255, 255, 255};

/// Random points of spheres with normals.
struct Spheres {
  void add(Vec3 center, double radius, int points) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    for (int i = 0; i < points; ++i) {
      Vec3 n{normal(random), normal(random), normal(random)};
      n = (1 / length(n)) * n;
      const Vec3 p = center + radius * n;
      xyz.insert(xyz.end(), {p.x, p.y, p.z});
      normals.insert(normals.end(), {n.x, n.y, n.z});
    }
  }
  Cloud cloud(bool with_normals) const {
    std::vector<std::unique_ptr<Reader>> readers;
    auto reader = std::make_unique<ArrayReader>(std::span<const double>(xyz));
    if (with_normals) reader->add({"nx", "ny", "nz"}, normals);
    readers.push_back(std::move(reader));
    return Cloud(std::move(readers));
  }
  std::vector<double> xyz, normals;
};

RenderOptions small(const char* color = "") {
  RenderOptions options;
  options.width = 200;
  options.height = 200;
  options.color = color;
  options.angles = Angles{0, 0};
  options.up = Up{};
  options.legend = false;
  return options;
}

Rgb pixel(const Rendering& r, std::size_t x, std::size_t y) { return r.picture.pixels[y * r.picture.width + x]; }

double covered(const Rendering& r) {
  const auto bare = std::count(r.picture.pixels.begin(), r.picture.pixels.end(), kWhitePixel);
  return 1 - static_cast<double>(bare) / static_cast<double>(r.picture.pixels.size());
}

TEST(Render, ASphereIsAClosedDiscOfTheRightSize) {
  Spheres spheres;
  spheres.add({10, 20, 30}, 2, 20000);
  for (const bool with_normals : {true, false}) {
    Cloud cloud = spheres.cloud(with_normals);
    const Rendering r = render(cloud, small());
    EXPECT_EQ(r.color, with_normals ? "plain" : "height");
    EXPECT_NEAR(covered(r), std::numbers::pi / 4 * 0.94 * 0.94, 0.06) << "discs reach a little over the edge";
    EXPECT_EQ(pixel(r, 2, 2), kWhitePixel);
    std::size_t bare = 0;
    for (std::size_t y = 60; y < 140; ++y)
      for (std::size_t x = 60; x < 140; ++x) bare += pixel(r, x, y) == kWhitePixel;
    EXPECT_LE(bare, with_normals ? 0u : 64u) << "of 6,400 pixels";
  }
}

TEST(Render, LightComesFromTheUpperLeft) {
  Spheres spheres;
  spheres.add({0, 0, 0}, 1, 50000);
  Cloud cloud = spheres.cloud(true);
  const Rendering r = render(cloud, small());
  EXPECT_GT(pixel(r, 80, 70).red, pixel(r, 130, 150).red + 40);
}

TEST(Render, NormalsThatPointAwayAreTurned) {
  Spheres spheres;
  spheres.add({0, 0, 0}, 1, 5000);
  Cloud cloud = spheres.cloud(true);
  const Rendering outward = render(cloud, small());
  for (double& n : spheres.normals) n = -n;
  Cloud turned = spheres.cloud(true);
  EXPECT_EQ(render(turned, small()).picture.pixels, outward.picture.pixels);
}

TEST(Render, TheNearerSphereHidesTheOther) {
  Spheres near_first, far_first;
  near_first.add({0, -5, 0}, 1, 20000);
  near_first.add({0, 5, 0}, 0.8, 20000);
  Cloud cloud = near_first.cloud(true);
  RenderOptions options = small("y");
  const Rendering front = render(cloud, options);
  EXPECT_LT(pixel(front, 100, 100).green, 10) << "y of what is near is small: violet";
  options.angles = Angles{180, 0};
  const Rendering back = render(cloud, options);
  EXPECT_GT(pixel(back, 100, 100).green, 150) << "y of what is near is large: yellow";
}

TEST(Render, AFlatCloudIsSeenFromAboveAndAnObjectFromACorner) {
  Spheres spheres;
  spheres.add({0, 0, 0}, 1, 5000);
  RenderOptions automatic;
  automatic.width = automatic.height = 100;
  Cloud object = spheres.cloud(true);
  EXPECT_EQ(render(object, automatic).view.angles, kThreeQuarter);
  for (std::size_t i = 2; i < spheres.xyz.size(); i += 3) spheres.xyz[i] *= 0.05;
  Cloud flat = spheres.cloud(true);
  const Rendering from_above = render(flat, automatic);
  EXPECT_EQ(from_above.view.angles, kTop);
  EXPECT_EQ(from_above.view.up, Up{});
  for (std::size_t i = 0; i < spheres.xyz.size(); i += 3) std::swap(spheres.xyz[i + 1], spheres.xyz[i + 2]);
  Cloud relief = spheres.cloud(true);
  EXPECT_EQ(render(relief, automatic).view.up, (Up{1, 1}));
  automatic.up = Up{};
  Cloud wall = spheres.cloud(true);
  EXPECT_EQ(render(wall, automatic).view.angles, kThreeQuarter) << "a wall with z up is not flat";
}

TEST(Render, EdgesAreSmooth) {
  Spheres spheres;
  spheres.add({0, 0, 0}, 1, 20000);
  Cloud cloud = spheres.cloud(true);
  const Rendering r = render(cloud, small("plain"));
  // Across the lower right edge of the disc, grey pixels between the dark side and the white background.
  std::vector<int> shades;
  for (std::size_t x = 100; x < 200; ++x) {
    for (std::size_t y = 100; y < 200; ++y) {
      const int red = pixel(r, x, y).red;
      if (red > 140 && red < 250) shades.push_back(red);
    }
  }
  std::sort(shades.begin(), shades.end());
  shades.erase(std::unique(shades.begin(), shades.end()), shades.end());
  EXPECT_GE(shades.size(), 6u) << "nine samples give up to eight shades between";
}

TEST(Render, TheLegendTakesItsOwnRoom) {
  Spheres spheres;
  spheres.add({0, 0, 0}, 1, 20000);
  Cloud cloud = spheres.cloud(false);
  RenderOptions options = small("height");
  options.width = 800;
  options.height = 600;
  const Rendering bare = render(cloud, options);
  options.legend = true;
  const Rendering with = render(cloud, options);
  EXPECT_EQ(pixel(bare, 790, 300), kWhitePixel);
  const auto colored_beyond = [&](const Rendering& r, std::size_t from) {
    std::size_t n = 0;
    for (std::size_t y = 0; y < 600; ++y)
      for (std::size_t x = from; x < 800; ++x) n += pixel(r, x, y) != kWhitePixel;
    return n;
  };
  EXPECT_EQ(colored_beyond(bare, 700), 0u);
  EXPECT_GT(colored_beyond(with, 700), 500u);
}

TEST(Render, HeightGoesFromVioletToYellow) {
  Spheres spheres;
  spheres.add({0, 0, 0}, 1, 30000);
  Cloud cloud = spheres.cloud(false);
  const Rendering r = render(cloud, small("height"));
  ASSERT_TRUE(r.is_number);
  EXPECT_NEAR(r.lo, -0.9, 0.02);
  EXPECT_NEAR(r.hi, 0.9, 0.02);
  const Rgb top = pixel(r, 100, 20), bottom = pixel(r, 100, 180);
  EXPECT_GT(top.red, 3 * top.blue);
  EXPECT_GT(bottom.blue, 3 * bottom.green);
}

TEST(Render, FarOutliersDoNotShrinkThePicture) {
  Spheres spheres;
  spheres.add({0, 0, 0}, 1, 30000);
  spheres.add({1000, 0, 500}, 1, 3);
  Cloud cloud = spheres.cloud(true);
  const Rendering rendering = render(cloud, small());
  EXPECT_GT(covered(rendering), 0.5);
  EXPECT_EQ(rendering.outside, 3u);
}

/// Returns the number of pixels in the outermost `rim` rows and columns that are not background.
std::size_t touched(const Rendering& r, unsigned rim) {
  std::size_t count = 0;
  for (unsigned y = 0; y < r.picture.height; ++y)
    for (unsigned x = 0; x < r.picture.width; ++x) {
      const bool at_rim = x < rim || y < rim || x >= r.picture.width - rim || y >= r.picture.height - rim;
      count += at_rim && pixel(r, x, y) != kWhitePixel;
    }
  return count;
}

TEST(Render, EverythingIsInsideFromAllSides) {
  Spheres spheres;  // with a few outlying points, fewer than one in a thousand
  spheres.add({0, 0, 0}, 1, 8000);
  for (const Vec3 far : {Vec3{2, 0, 0}, {-2, 0, 1}, {0, 2, -1}, {0, -2, 0}, {0.5, 0, 2}, {0, 0.3, -2}})
    spheres.add(far, 0.01, 1);
  for (const bool normals : {true, false}) {
    Cloud cloud = spheres.cloud(normals);
    for (const auto& angles : {std::optional<Angles>(), std::optional(Angles{0, 0}), std::optional(Angles{40, 70})}) {
      RenderOptions options = small("plain");
      options.angles = angles, options.up.reset();
      for (const double size : {0.0, 20.0}) {
        options.point_size = size;
        const Rendering rendering = render(cloud, options);
        EXPECT_EQ(rendering.outside, 0u);
        EXPECT_EQ(touched(rendering, 1), 0u) << "points of " << size << " pixels";
        EXPECT_GT(touched(rendering, 40), 0u) << "but far from the rim";
      }
    }
  }
}

TEST(Render, DrawsAsManyPointsAsThereIsTimeFor) {
  Spheres sphere;
  sphere.add({0, 0, 0}, 1, 60000);
  Cloud cloud = sphere.cloud(true);
  RenderOptions options = small("plain");
  const Rendering all = render(cloud, options);
  EXPECT_EQ(all.drawn, 60000u);
  options.seconds = 1e-3;  // too short for a third of the points
  const Rendering some = render(cloud, options);
  EXPECT_LT(some.drawn, 20000u);
  EXPECT_NEAR(covered(some), covered(all), 0.1) << "by larger discs";
  options.seconds = 1000;
  EXPECT_EQ(render(cloud, options).picture.pixels, all.picture.pixels);
}

TEST(Render, EveryPointHasTheSizeAskedFor) {
  Spheres sphere;
  sphere.add({0, 0, 0}, 1, 1);
  Cloud cloud = sphere.cloud(true);
  RenderOptions options = small("plain");
  for (const double size : {3.0, 20.0}) {
    options.point_size = size;
    const double disc = std::numbers::pi * size * size / 4 / (200.0 * 200);
    EXPECT_NEAR(covered(render(cloud, options)), disc, 0.3 * disc + 1e-4) << size;
  }
}

TEST(Render, MapCoordinatesGiveTheSamePicture) {
  Spheres here, there;
  here.add({0, 0, 0}, 1, 5000);
  for (double& v : here.xyz) v = std::round(v * 1024) / 1024;
  there = here;
  for (std::size_t i = 0; i < there.xyz.size(); i += 3) there.xyz[i] += 1 << 20, there.xyz[i + 1] += 1 << 22;
  Cloud a = here.cloud(true), b = there.cloud(true);
  EXPECT_EQ(render(a, small()).picture.pixels, render(b, small()).picture.pixels);
}

TEST(Render, SplatsHaveTheirSizeAndDirection) {
  // One splat in the middle of four corners that frame the picture; 4 units are 188 pixels.
  const std::vector<double> xyz = {0, 0, 0, -2, 0, -2, 2, 0, -2, -2, 0, 2, 2, 0, 2};
  std::vector<double> normals, axes, sizes;
  for (int i = 0; i < 5; ++i) {
    normals.insert(normals.end(), {0, 1, 0});
    axes.insert(axes.end(), {0, 0, 1});
    sizes.insert(sizes.end(), {i == 0 ? 0.4 : 1e-6, 0.5});
  }
  auto reader = std::make_unique<ArrayReader>(std::span<const double>(xyz));
  reader->add({"nx", "ny", "nz"}, normals);
  reader->add({"splat_x", "splat_y", "splat_z"}, axes);
  reader->add({"splat_length", "splat_ratio"}, sizes);
  std::vector<std::unique_ptr<Reader>> readers;
  readers.push_back(std::move(reader));
  Cloud cloud(std::move(readers));
  const Rendering r = render(cloud, small());
  const double pixels = 0.94 * 200 / 4;
  EXPECT_NEAR(covered(r) * 200 * 200, std::numbers::pi * 0.4 * 0.2 * pixels * pixels, 55)
      << "with what is partly covered at its edge";
  EXPECT_NE(pixel(r, 100, 100 - 17), kWhitePixel);
  EXPECT_EQ(pixel(r, 100 - 17, 100), kWhitePixel);
}

/// A reader that records how it is read.
class WatchedReader final : public Reader {
 public:
  explicit WatchedReader(std::uint64_t count) {
    for (const char* name : {"x", "y", "z"}) info_.schema.append(name, Type::f64);
    info_.count = count;
  }
  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    largest = std::max(largest, records.size());
    jumps += row != next;
    std::size_t n = 0;
    for (; (n + 1) * 24 <= records.size() && row + n < info_.count; ++n) {
      const double at = static_cast<double>((row + n) * 7919 % 100003);
      for (std::uint32_t axis = 0; axis < 3; ++axis) set_value(info_.schema.fields[axis], &records[n * 24], at * axis);
    }
    next = row + n;
    rows += n;
    return n;
  }
  std::size_t largest = 0;
  std::uint64_t jumps = 0, next = 0, rows = 0;
};

TEST(Render, ReadsTheCloudTwiceInOrderAndInSmallBlocks) {
  std::vector<std::unique_ptr<Reader>> readers;
  readers.push_back(std::make_unique<WatchedReader>(300000));
  const auto* watched = static_cast<const WatchedReader*>(readers.front().get());
  Cloud cloud(std::move(readers));
  render(cloud, small());
  EXPECT_EQ(watched->rows, 600000u);
  EXPECT_EQ(watched->jumps, 1u) << "back to the first row";
  EXPECT_LE(watched->largest, 1u << 20);
}

TEST(Render, PointsWithoutAPlaceAreLeftOut) {
  Spheres spheres;
  spheres.add({0, 0, 0}, 1, 3000);
  Cloud clean = spheres.cloud(true);
  const Rendering expected = render(clean, small());
  spheres.xyz.insert(spheres.xyz.end(), {NAN, 0, 0, INFINITY, 0, 0});
  spheres.normals.resize(spheres.xyz.size(), 0);
  Cloud damaged = spheres.cloud(true);
  EXPECT_EQ(render(damaged, small()).picture.pixels, expected.picture.pixels);
  const std::vector<double> nothing = {NAN, 0, 0};
  std::vector<std::unique_ptr<Reader>> readers;
  readers.push_back(std::make_unique<ArrayReader>(std::span<const double>(nothing)));
  Cloud empty(std::move(readers));
  EXPECT_THROW(render(empty, small()), Error);
}

TEST(Render, RefusesSizesThatAreNone) {
  Spheres spheres;
  spheres.add({0, 0, 0}, 1, 10);
  Cloud cloud = spheres.cloud(true);
  for (const auto& [width, height] : {std::pair(0u, 100u), std::pair(100u, 20000u), std::pair(16384u, 16384u)}) {
    RenderOptions options;
    options.width = width;
    options.height = height;
    EXPECT_THROW(render(cloud, options), UsageError);
  }
}

TEST(Png, ComesBackAsItWas) {
  Picture picture{37, 23, {}};
  for (unsigned i = 0; i < 37 * 23; ++i) {
    picture.pixels.push_back(
        {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i * 7), static_cast<std::uint8_t>(i / 3)});
  }
  const auto bytes = to_png(picture);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()), 0);
  image.format = PNG_FORMAT_RGB;
  ASSERT_EQ(image.width, 37u);
  ASSERT_EQ(image.height, 23u);
  std::vector<Rgb> pixels(37 * 23);
  ASSERT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0);
  EXPECT_EQ(pixels, picture.pixels);
}

}  // namespace
}  // namespace pointsweep
