// SPDX-License-Identifier: MIT
/// The operators sample and parts against their definitions, over the whole cloud.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>
#include <tuple>

#include "pointsweep/operators.h"
#include "tests/pipeline/kept_rows.h"
#include "tests/pipeline/plain_hash.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

std::uint64_t hash_of_point(Vec3 p, std::uint64_t seed) { return plain_hash({p.x, p.y, p.z}, seed); }

/// Returns which rows the operator sample keeps, by sorting all rows.
std::vector<bool> sampled(const std::vector<Vec3>& points, std::size_t number, std::uint64_t seed, bool rest) {
  std::vector<std::pair<std::uint64_t, std::size_t>> rows;
  std::vector<bool> keep(points.size(), true);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (is_finite(points[i])) rows.emplace_back(hash_of_point(points[i], seed) / 2048, i);
  std::ranges::sort(rows);
  for (std::size_t place = 0; place < rows.size(); ++place) keep[rows[place].second] = (place < number) != rest;
  return keep;
}

TEST(Sample, KeepsExactlyThePointsOfTheLeastHashesOrAllOthers) {
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    std::vector<Vec3> points = make_cloud(shape, sized(500), 51);
    for (int i = 1; i < 9; ++i) points.push_back({0.0, -0.0, 1.0 * i}), points.push_back({-0.0, 0.0, 1.0 * i});
    const Records input = with_attributes(points);
    const std::size_t finite =
        static_cast<std::size_t>(std::ranges::count_if(points, [](Vec3 p) { return is_finite(p); }));
    for (const std::size_t number : {std::size_t{1}, std::size_t{77}, finite - 1, finite, finite + 9})
      for (const bool rest : {false, true}) {
        const std::uint64_t seed = number % 2 == 0 ? 6 : 0;
        const std::string text = fmt::format("sample({}, rest={}, seed={})", number, rest ? "yes" : "no", seed);
        const Records kept = input.kept(sampled(points, number, seed, rest));
        const std::size_t expected = std::min(number, finite), others = points.size() - finite;
        ASSERT_EQ(kept.size(), others + (rest ? finite - expected : expected)) << text;
        for (const EngineOptions& options : ways_to_run(Order::input))
          ASSERT_TRUE(run_text(input, text, options).records == kept.bytes) << text;
      }
    const Records some = input.kept(sampled(points, 77, 0, false));
    expect_as_over(input, "knn(k=5) | sample(77) | normals", some, "knn(k=5) | normals");
  }
}

std::set<std::tuple<double, double, double>> sampled_places(const std::vector<Vec3>& points, const std::string& text,
                                                            std::optional<int> axis = {}) {
  EngineOptions options = tiny(200);
  options.axis = axis;
  const RunResult result = run_in_memory(points, chain_of_any_cloud(text), options);
  const std::vector<double> x = result.field("x"), y = result.field("y"), z = result.field("z");
  std::set<std::tuple<double, double, double>> places;
  for (std::size_t i = 0; i < x.size(); ++i) places.emplace(x[i], y[i], z[i]);
  return places;
}

TEST(Sample, OfANumberLiesInThatOfTwiceTheNumberAndIsTheSameForAnyOrderOfRowsAndAxis) {
  std::vector<Vec3> points = make_cloud(hostile_shapes()[1].second, 3000, 52);
  const auto few = sampled_places(points, "sample(300)"), more = sampled_places(points, "sample(600)");
  EXPECT_EQ(few.size(), 300u);
  EXPECT_TRUE(std::ranges::includes(more, few));
  for (const int axis : {0, 1, 2}) EXPECT_EQ(sampled_places(points, "sample(300)", axis), few);
  EXPECT_EQ(sampled_places(points, "sample(600) | sample(300)"), few);
  EXPECT_NE(sampled_places(points, "sample(300, seed=1)"), few);
  auto both = sampled_places(points, "sample(300, rest=yes)");
  EXPECT_EQ(both.size(), 2700u);
  both.insert(few.begin(), few.end());
  EXPECT_EQ(both.size(), 3000u);
  const auto share = sampled_places(points, "decimate(0.1)");
  EXPECT_EQ(sampled_places(points, fmt::format("sample({})", share.size())), share);
  std::ranges::shuffle(points, std::mt19937_64(1));
  EXPECT_EQ(sampled_places(points, "sample(300)"), few);
}

TEST(Sample, CountsTheRowsThatEarlierStagesLeave) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[0].second, sized(600), 53));
  const Records first = input.those([&](std::size_t i) { return input.value(i, "classification") < 6; });
  const Records kept = first.kept(sampled(first.positions(), 100, 0, false));
  expect_as_over(input, "knn(k=4) | where(classification < 6) | sample(100) | normals", kept, "knn(k=4) | normals");
}

TEST(Sample, SpreadsEvenlyOverTheCloud) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[1].second, 20'000, 54);
  std::vector<double> in_tile(64);
  for (const auto& [x, y, z] : sampled_places(points, "sample(6400)"))
    ++in_tile[static_cast<std::size_t>(8 * x) * 8 + static_cast<std::size_t>(8 * y)];
  double chi2 = 0;
  for (const double count : in_tile) chi2 += (count - 100) * (count - 100) / 100;
  EXPECT_LT(chi2, 64 + 5 * std::sqrt(2 * 64.0));
}

TEST(Sample, RefusesNumbersThatKeepNothing) {
  for (const char* wrong : {"sample", "sample(0)", "sample(-1)", "sample(2.5)", "sample(5, rest=maybe)"})
    EXPECT_NE(refusal([&] { chain_of_any_cloud(wrong); }), "") << wrong;
  EXPECT_NE(refusal([] { operators::sample({}); }).find("number is a whole number, 1 or more, not '0'"),
            std::string::npos);
}

TEST(Parts, AreTheHashInEqualIntervals) {
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    std::vector<Vec3> points = make_cloud(shape, sized(400), 55);
    points.push_back({0.0, -0.0, 1}), points.push_back({-0.0, 0.0, 1});
    const Records input = with_attributes(points);
    for (const std::uint64_t number : {1u, 10u, 65536u}) {
      const Records out = records_of(run_text(input, fmt::format("parts({}, seed=3)", number), tiny(90)));
      for (std::size_t i = 0; i < points.size(); ++i) {
        // Finds the interval of length 2^64 / number that holds the hash, by long multiplication in digits of 16 bits.
        std::uint64_t carry = 0, part = 0;
        for (int shift = 0; shift < 64; shift += 16) {
          const std::uint64_t digits = hash_of_point(points[i], 3 + 0x7061727473) >> shift & 0xffff;
          part = digits * number + carry;
          carry = part >> 16;
        }
        ASSERT_EQ(out.value(i, "part"), is_finite(points[i]) ? static_cast<double>(carry) : 0) << i;
      }
    }
  }
}

TEST(Parts, AreDisjointCompleteAndOfAboutTheSameSize) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[1].second, 20'000, 56);
  std::set<std::tuple<double, double, double>> all;
  for (int part = 0; part < 5; ++part) {
    const auto places = sampled_places(points, fmt::format("parts(5) | where(part == {})", part));
    EXPECT_NEAR(static_cast<double>(places.size()), 4000, 5 * std::sqrt(20'000 * 0.2 * 0.8));
    all.insert(places.begin(), places.end());
  }
  EXPECT_EQ(all.size(), points.size());
  for (const char* wrong : {"parts", "parts(0)", "parts(65537)"})
    EXPECT_NE(refusal([&] { chain_of_any_cloud(wrong); }), "") << wrong;
}

TEST(Parts, APartOfASampleIsAsLargeAsAnother) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[0].second, 20000, 56));
  for (const char* chosen : {"sample(2000)", "sample(2000, rest=yes)", "decimate(0.1)"}) {
    const Records out = records_of(run_text(input, fmt::format("{} | parts(4)", chosen), tiny(2000)));
    std::array<std::size_t, 4> sizes{};
    for (std::size_t i = 0; i < out.size(); ++i) ++sizes.at(static_cast<std::size_t>(out.value(i, "part")));
    for (const std::size_t size : sizes)
      EXPECT_NEAR(static_cast<double>(size), static_cast<double>(out.size()) / 4, static_cast<double>(out.size()) / 16)
          << chosen;
  }
}

}  // namespace
}  // namespace pointsweep
