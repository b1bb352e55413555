// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>

#include "pointsweep/error.h"
#include "pointsweep/threads.h"
#include "tests/shapes/shapes.h"

namespace pointsweep {
namespace {

Sampling many_options() {
  Sampling sampling;
  sampling.count = 30'001;
  sampling.seed = 7;
  sampling.noise = 0.01;
  sampling.outliers = 0.1;
  return sampling;
}

TEST(ShapeReader, MakesTheSameBytesInPiecesOfAnySize) {
  for (const auto& shape : all_shapes()) {
    const std::vector<std::byte> whole = records_of(shape->name(), many_options());
    const auto reader = generated_points(shape->name(), many_options());
    const std::size_t stride = reader->info().schema.stride;
    std::vector<std::byte> pieces(whole.size());
    std::uint64_t row = 0;
    for (std::size_t size = 1; row < reader->info().count; size = size * 3 + 1)
      row += reader->read(
          row, std::span(pieces).subspan(row * stride).first(std::min(size * stride, pieces.size() - row * stride)));
    EXPECT_EQ(pieces, whole) << shape->name();
  }
}

TEST(ShapeReader, MakesTheSameBytesWithAnyNumberOfThreads) {
  const auto records_with = [](unsigned threads) {
    std::vector<std::byte> records;
    with_threads(threads, [&] { records = records_of("statue", many_options()); });
    return records;
  };
  EXPECT_EQ(records_with(1), records_with(4));
}

/// Returns the FNV-1a hash of the coordinates, which a change of a single bit changes.
std::uint64_t fingerprint(const std::vector<std::byte>& bytes) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::byte b : bytes) hash = (hash ^ static_cast<std::uint64_t>(b)) * 0x100000001b3;
  return hash;
}

TEST(ShapeReader, MakesTheSameBytesOnEveryMachine) {
  Sampling sampling = many_options();
  sampling.float64 = true;
  std::uint64_t all = 0;
  for (const auto& shape : all_shapes()) all = all * 31 + fingerprint(records_of(shape->name(), sampling));
  EXPECT_EQ(all, 11645710186393204965u);
}

TEST(ShapeReader, RowsDoNotDependOnTheCount) {
  Sampling more = many_options();
  more.count = 10'000'000'000;
  const auto reader = generated_points("tls", more);
  std::vector<std::byte> start(reader->info().schema.stride * many_options().count);
  EXPECT_EQ(reader->read(0, start), many_options().count);
  EXPECT_EQ(start, records_of("tls", many_options()));
}

TEST(ShapeReader, RowsBeyond32BitsAreNewPoints) {
  Sampling huge;
  huge.count = 10'000'000'000;
  const auto reader = generated_points("sphere", huge);
  std::vector<std::byte> low(24 * 100), high(24 * 100), past(24 * 100);
  EXPECT_EQ(reader->read(0, low), 100u);
  EXPECT_EQ(reader->read(1ull << 32, high), 100u);
  EXPECT_NE(low, high);
  EXPECT_EQ(reader->read(huge.count - 60, past), 60u);
  EXPECT_EQ(reader->read(huge.count, past), 0u);
}

TEST(ShapeReader, AnotherSeedGivesOtherPoints) {
  Sampling other = many_options();
  other.seed = 8;
  EXPECT_NE(records_of("plane", other), records_of("plane", many_options()));
}

TEST(ShapeReader, Float32IsFloat64Rounded) {
  Sampling sampling;
  sampling.count = 1000;
  const std::vector<std::byte> narrow = records_of("torus", sampling);
  const std::vector<SurfacePoint> wide = points_of("torus", sampling);
  for (std::size_t i = 0; i < wide.size(); ++i) {
    float xyz[3];
    std::memcpy(xyz, narrow.data() + 24 * i, 12);
    EXPECT_EQ(xyz[2], static_cast<float>(wide[i].position.z));
  }
}

TEST(ShapeReader, TheOriginMovesThePointsAndNothingElse) {
  Sampling sampling;
  sampling.count = 1000;
  const auto here = points_of("statue", sampling);
  sampling.origin = {500000, 4100000, 250};
  const auto there = points_of("statue", sampling);
  for (std::size_t i = 0; i < here.size(); ++i) {
    EXPECT_EQ(there[i].position, here[i].position + sampling.origin);
    EXPECT_EQ(there[i].normal, here[i].normal);
  }
}

TEST(ShapeReader, NoiseIsGaussianAlongEachAxisAndLeavesTheNormals) {
  Sampling sampling;
  sampling.count = 100'000;
  const auto clean = points_of("torus", sampling);
  sampling.noise = 0.02;
  const auto noisy = points_of("torus", sampling);
  for (int axis = 0; axis < 3; ++axis) {
    double sum = 0, sum2 = 0, within = 0;
    for (std::size_t i = 0; i < clean.size(); ++i) {
      const double d = noisy[i].position[axis] - clean[i].position[axis];
      sum += d, sum2 += d * d;
      within += std::abs(d) < sampling.noise ? 1 : 0;
      ASSERT_EQ(noisy[i].normal, clean[i].normal);
    }
    const double n = static_cast<double>(clean.size());
    EXPECT_NEAR(sum / n, 0, 5 * sampling.noise / std::sqrt(n));
    EXPECT_NEAR(std::sqrt(sum2 / n), sampling.noise, 0.01 * sampling.noise);
    EXPECT_NEAR(within / n, 0.6827, 0.008);
  }
}

TEST(ShapeReader, OutliersFillTheirBoxAndHaveNoNormal) {
  Sampling sampling;
  sampling.count = 100'000;
  const auto clean = points_of("torus", sampling);
  sampling.outliers = 0.03;
  sampling.outlier_box = 10;
  const auto cloud = points_of("torus", sampling);
  int outliers = 0;
  Box box;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud[i].normal == Vec3{}) {
      ++outliers;
      box.include(cloud[i].position);
    } else {
      ASSERT_EQ(cloud[i].position, clean[i].position) << "the other points stay where they are";
    }
  }
  EXPECT_NEAR(outliers, 3000, 5 * std::sqrt(3000));
  EXPECT_NEAR(box.extent().x, 10 * 2.6, 0.1);
  EXPECT_NEAR(box.extent().z, 10 * 0.6, 0.03);
}

TEST(ShapeReader, StatesABoxThatHoldsEveryPoint) {
  Sampling sampling = many_options();
  sampling.origin = {1000, 2000, 3000};
  for (const double outliers : {0.0, 0.1}) {
    sampling.outliers = outliers;
    const Box stated = *generated_points("sphere", sampling)->info().bounds;
    Box both = stated;
    for (const SurfacePoint& p : points_of("sphere", sampling)) both.include(p.position);
    EXPECT_EQ(both, stated);
    EXPECT_LT(stated.diagonal(), outliers > 0 ? 73 : 5);
  }
}

TEST(ShapeReader, RefusesValuesOutOfRange) {
  const auto refused = [](auto change) {
    Sampling sampling;
    change(sampling);
    EXPECT_THROW(generated_points("plane", sampling), UsageError);
  };
  refused([](Sampling& s) { s.noise = -1; });
  refused([](Sampling& s) { s.noise = std::nan(""); });
  refused([](Sampling& s) { s.outliers = 1.5; });
  refused([](Sampling& s) { s.outliers = std::nan(""); });
  refused([](Sampling& s) { s.outlier_box = 0; });
  refused([](Sampling& s) { s.origin.y = INFINITY; });
}

}  // namespace
}  // namespace pointsweep
