// SPDX-License-Identifier: MIT
#include "pointsweep/operators/statistics/neighbor_rows.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "pointsweep/neighborhood.h"
#include "pointsweep/points/degenerate_points.h"

namespace pointsweep {
namespace {

/// Returns the neighbours that the operator makes for two points at `rows`, each of which is the neighbour of the
/// other.
template <class Row>
std::vector<Row> neighbors_of_two(const NeighborRows& op, std::array<std::uint64_t, 2> rows) {
  const double x[] = {0, 1}, yz[] = {0, 0};
  const PointColumns points{x, yz, yz, rows.data(), nullptr};
  const std::uint32_t begin[] = {0, 1, 2};
  const NeighborRef refs[] = {make_ref(0, 1), make_ref(0, 0)};
  std::vector<Row> made(4);
  std::vector<std::byte*> columns = {reinterpret_cast<std::byte*>(made.data())};
  DegeneratePoints degenerate;
  Columns out(columns, 2, degenerate);
  op.apply(Neighborhoods(points, 2, &points, begin, refs, {}, {}), out);
  return made;
}

TEST(NeighborRows, HaveThirtyTwoBitsAsLongAsTheyDo) {
  const NeighborRows op(2, 0xFFFFFFFE, false);
  EXPECT_EQ(op.contract().makes.front().type, Type::u32);
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  EXPECT_EQ(neighbors_of_two<std::uint32_t>(op, {7, 0xFFFFFFFD}), (std::vector{0xFFFFFFFDu, kNone, 7u, kNone}));
}

TEST(NeighborRows, GoPastFourBillion) {
  for (const std::uint64_t rows : {std::uint64_t{0xFFFFFFFF}, std::uint64_t{5'000'000'000}}) {
    const NeighborRows op(2, rows, false);
    EXPECT_EQ(op.contract().makes.front().type, Type::u64) << "the largest value means that there is none";
    constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();
    EXPECT_EQ(neighbors_of_two<std::uint64_t>(op, {4'294'967'297, 4'999'999'999}),
              (std::vector<std::uint64_t>{4'999'999'999, kNone, 4'294'967'297, kNone}));
  }
}

}  // namespace
}  // namespace pointsweep
