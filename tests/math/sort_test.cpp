// SPDX-License-Identifier: MIT
#include "pointsweep/math/sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <utility>
#include <vector>

namespace pointsweep {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

/// Returns n numbers of both signs and any magnitude, many of them equal.
std::vector<double> numbers(std::size_t n) {
  std::mt19937_64 random(n);
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) {
    const double some[] = {double(random() % 100) - 50,
                           std::ldexp(double(random()), int(random() % 2000) - 1060),
                           -std::ldexp(double(random()), int(random() % 2000) - 1060),
                           kInf,
                           -kInf,
                           1e-320};
    out.push_back(some[random() % 6]);
  }
  return out;
}

TEST(Sort, PutsNumbersInOrder) {
  for (const std::size_t n : {0, 1, 2, 15, 16, 17, 100, 1000, 65536}) {
    SCOPED_TRACE(n);
    std::vector<double> sorted = numbers(n), expected = sorted;
    std::ranges::sort(expected);
    sort_ascending(std::span(sorted));
    EXPECT_EQ(sorted, expected);

    std::mt19937_64 random(n);
    std::vector<std::uint64_t> codes(n);
    for (std::uint64_t& code : codes) code = random() >> random() % 64;
    std::vector<std::uint64_t> expected_codes = codes;
    std::ranges::sort(expected_codes);
    sort_ascending(std::span(codes));
    EXPECT_EQ(codes, expected_codes);
  }
}

TEST(Sort, PutsPairsInOrderOfTheFirstThenOfTheSecond) {
  for (const std::size_t n : {0, 1, 7, 1000, 65536}) {
    SCOPED_TRACE(n);
    const std::vector<double> first = numbers(n), second = numbers(n + 1);
    std::vector<std::pair<double, double>> pairs;
    for (std::size_t i = 0; i < n; ++i) pairs.emplace_back(first[i], second[i]);
    std::vector<std::pair<double, double>> expected = pairs;
    std::ranges::sort(expected);
    sort_ascending(std::span(pairs));
    EXPECT_EQ(pairs, expected);
  }
}

}  // namespace
}  // namespace pointsweep
