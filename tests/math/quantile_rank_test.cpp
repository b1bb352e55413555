// SPDX-License-Identifier: MIT
/// Ranks of quantiles against counting.
#include "pointsweep/math/quantile_rank.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <utility>

namespace pointsweep {
namespace {

/// Returns the rank by counting the steps of 1 / (count - 1) that fit into part / whole.
std::uint64_t by_counting(std::uint64_t count, std::uint32_t part, std::uint32_t whole) {
  std::uint64_t rank = 0;
  while ((rank + 1) * whole <= part * (count - 1)) ++rank;
  return rank;
}

TEST(QuantileRank, IsTheGreatestRankWhoseShareIsNotMore) {
  for (std::uint64_t count = 1; count < 300; ++count)
    for (const auto& [part, whole] : {std::pair{0u, 100u},
                                      {1u, 100u},
                                      {5u, 100u},
                                      {50u, 100u},
                                      {95u, 100u},
                                      {99u, 100u},
                                      {100u, 100u},
                                      {1u, 200u},
                                      {199u, 200u}})
      ASSERT_EQ(quantile_rank(count, part, whole), by_counting(count, part, whole)) << count << " " << part;
}

TEST(QuantileRank, DoesNotRoundForAnyCount) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(quantile_rank(kMost, 100), kMost - 1);
  EXPECT_EQ(quantile_rank(kMost, 50), (kMost - 1) / 2);
}

}  // namespace
}  // namespace pointsweep
