// SPDX-License-Identifier: MIT
/// Edges that several processes have put into buckets, in one.
#include "pointsweep/connect/edge_buckets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <tuple>
#include <vector>

#include "pointsweep/connect/components.h"
#include "pointsweep/fail.h"
#include "tests/support/scratch_in_memory.h"

namespace pointsweep {
namespace {

using Label = std::tuple<std::uint64_t, std::uint64_t, bool>;

constexpr std::size_t kPoints = 500;

MakeScratch in_memory_scratch() {
  return []() -> std::unique_ptr<Scratch> { return std::make_unique<ScratchInMemory>(); };
}

/// Three buckets along x.
struct ThreeBuckets : EdgeBuckets {
  explicit ThreeBuckets(bool weighted, double first_begin = 100)
      : EdgeBuckets({{{300, 0, 0}, 0}, {{first_begin, 0, 0}, 0}}, 0, weighted, 0, in_memory_scratch()) {}
};

PointKey point(std::uint64_t row) { return {{static_cast<double>(row * 7 % kPoints), 0, 0}, row}; }

/// The edges of ten points of their own.
void put_some(EdgeBuckets& buckets, std::uint64_t first) {
  std::mt19937_64 random(first);
  EdgeBatch batch;
  for (std::uint64_t row = first; row < first + 10; ++row) batch.number_of(point(row));
  for (std::uint32_t a = 0; a < 10; a += 2) {
    const std::uint64_t row = random() % kPoints;
    const double weight = static_cast<double>((row + first + a) % 5);
    if (row != first + a) batch.add(a, batch.number_of(point(row)), weight, random() % 2 == 0);
  }
  buckets.put(batch, 10, {});
}

std::vector<Label> labels(const EdgeBuckets& buckets) {
  const ComponentsSetup setup{
      .votes = nullptr, .make_scratch = in_memory_scratch(), .memory_bytes = 1 << 20, .progress = {}};
  const Components components(buckets, setup);
  std::vector<Label> labels(kPoints);
  components.for_each_point([&](std::uint64_t row, const ComponentLabel& label) {
    labels[row] = {label.number, label.points, label.flips};
  });
  return labels;
}

std::vector<std::byte> bytes_of(const EdgeBuckets& buckets) {
  Encoder out;
  buckets.encode(out);
  return out.take();
}

TEST(EdgeBuckets, TakeWhatOtherProcessesHavePut) {
  for (const bool weighted : {false, true}) {
    ThreeBuckets whole(weighted), all(weighted), even(weighted), odd(weighted);
    for (std::uint64_t first = 0; first < kPoints; first += 10) {
      put_some(whole, first);
      put_some(first % 20 == 0 ? even : odd, first);
    }
    for (const EdgeBuckets* half : {&odd, &even}) {
      const std::vector<std::byte> bytes = bytes_of(*half);
      Decoder in(bytes);
      all.add(in);
      in.finish();
    }
    const std::vector<Label> expected = labels(whole);
    EXPECT_EQ(labels(all), expected);
    EXPECT_GT(std::get<0>(*std::ranges::max_element(expected)), 3u);
  }
}

TEST(EdgeBuckets, RefuseThoseOfOtherBuckets) {
  const std::vector<std::byte> bytes = bytes_of(ThreeBuckets(true));
  ThreeBuckets same(true), without_weights(false), elsewhere(true, 101);
  for (EdgeBuckets* other : {&without_weights, &elsewhere}) {
    Decoder in(bytes);
    EXPECT_THROW(other->add(in), Error);
  }
  Decoder in(bytes);
  same.add(in);
}

}  // namespace
}  // namespace pointsweep
