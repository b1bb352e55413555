// SPDX-License-Identifier: MIT
/// Compares the choice of levels with an oracle: octants by division of doubles, leaves by recursion, and one loop over
/// all points for each depth. The oracle takes the cube and the order of points from the library.
/// verify/formulas/levels derives both on its own, and tests/cli compares the stage `level` with it.
#include "pointsweep/levels/level_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <random>
#include <set>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "pointsweep/levels/curve_records.h"
#include "pointsweep/threads.h"
#include "tests/support/scratch_in_memory.h"

namespace pointsweep {
namespace {

struct Cloud {
  std::vector<GridPoint> points;
  Vec3 scale{0.01, 0.01, 0.01};
};

GridBounds bounds_of(const std::vector<GridPoint>& points) {
  GridBounds bounds{points[0], points[0]};
  for (const GridPoint& p : points)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bounds.lo[axis] = std::min(bounds.lo[axis], p[axis]);
      bounds.hi[axis] = std::max(bounds.hi[axis], p[axis]);
    }
  return bounds;
}

struct Level {
  GridPoint point;
  int depth;
  friend auto operator<=>(const Level&, const Level&) = default;
};

struct Result {
  std::vector<Level> levels;
  double spacing;
};

Result run(const Cloud& cloud, std::uint64_t memory, bool files) {
  struct Record {
    GridPoint point;
    std::uint32_t row;
  };
  std::vector<Record> records;
  for (std::uint32_t i = 0; i < cloud.points.size(); ++i) records.push_back({cloud.points[i], i});
  const MakeScratch make = [] { return std::make_unique<ScratchInMemory>(); };
  CurveRecords sorted(sizeof(Record), memory, files ? make : MakeScratch());
  for (std::size_t at = 0; at < records.size(); at += 1000)
    sorted.add(std::as_bytes(std::span(records).subspan(at, std::min<std::size_t>(1000, records.size() - at))));
  const LevelGrid grid(sorted.bounds(), cloud.scale);
  sorted.sort(grid);
  ScratchRoom room(files ? 0 : memory, files ? make : MakeScratch());
  CurvePoints points(grid, sorted.count(), room);
  LeafFinder finder;
  sorted.for_each([&](std::span<const std::byte> some, std::span<const CurveKey> keys) {
    finder.add(keys);
    points.add(some, sizeof(Record));
  });
  LevelChoice choice(points, finder.finish(), room, memory);
  choice.run();
  Result result{{}, choice.spacing()};
  sorted.for_each([&](std::span<const std::byte> some, std::span<const CurveKey>) {
    for (std::size_t at = 0; at < some.size(); at += sizeof(Record)) {
      Record record;
      std::memcpy(&record, &some[at], sizeof record);
      result.levels.push_back({record.point, choice.next_depth()});
    }
  });
  std::ranges::sort(result.levels);
  return result;
}

class Oracle {
 public:
  explicit Oracle(const Cloud& cloud) : cloud_(cloud), grid_(bounds_of(cloud.points), cloud.scale) {
    std::vector<std::size_t> all(cloud.points.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    leaf_depth_.resize(all.size());
    divide(all, 0);
  }

  Result levels() {
    double spacing = 0;
    for (int growth = 0;; ++growth) {
      spacing = grid_.width() / 128 * std::exp2(0.5 * growth);
      depth_.assign(cloud_.points.size(), -1);
      take(0, spacing);
      const auto in_root = std::ranges::count(depth_, 0);
      if (in_root <= 100'000 || *std::ranges::max_element(leaf_depth_) == 0) break;
    }
    for (int depth = 1; depth <= *std::ranges::max_element(leaf_depth_); ++depth)
      take(depth, std::ldexp(spacing, -depth));
    Result result{{}, spacing};
    for (std::size_t i = 0; i < depth_.size(); ++i) result.levels.push_back({cloud_.points[i], depth_[i]});
    std::ranges::sort(result.levels);
    return result;
  }

 private:
  struct CellHash {
    std::size_t operator()(const std::array<std::int64_t, 3>& at) const {
      return static_cast<std::size_t>((at[0] * 73856093) ^ (at[1] * 19349663) ^ (at[2] * 83492791));
    }
  };
  using Cells = std::unordered_map<std::array<std::int64_t, 3>, std::vector<std::size_t>, CellHash>;

  std::array<std::int64_t, 3> octant(std::size_t i, int depth) const {
    const Vec3 p = grid_.place(cloud_.points[i]);
    std::array<std::int64_t, 3> at;
    for (int axis = 0; axis < 3; ++axis) {
      const double cell = std::min(p[axis] * (0x1p31 / grid_.width()), 0x1p31 - 1);
      at[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(cell) >> (31 - depth);
    }
    return at;
  }
  void divide(const std::vector<std::size_t>& rows, int depth) {
    std::set<GridPoint> places;
    for (const std::size_t i : rows) places.insert(cloud_.points[i]);
    if (rows.size() <= 100'000 || places.size() == 1 || depth == 31) {
      for (const std::size_t i : rows) leaf_depth_[i] = depth;
      return;
    }
    std::map<std::array<std::int64_t, 3>, std::vector<std::size_t>> children;
    for (const std::size_t i : rows) children[octant(i, depth + 1)].push_back(i);
    for (const auto& [at, child] : children) divide(child, depth + 1);
  }

  void take(int depth, double spacing) {
    for (std::size_t i = 0; i < depth_.size(); ++i)
      if (leaf_depth_[i] == depth && depth_[i] < 0) depth_[i] = depth;
    // The grid only makes the search faster: all points of the neighbouring cells are compared.
    Cells cells;
    const auto cell = [&](std::size_t i) {
      const Vec3 p = grid_.place(cloud_.points[i]);
      const double edge = spacing * 1.001;
      return std::array<std::int64_t, 3>{static_cast<std::int64_t>(p.x / edge), static_cast<std::int64_t>(p.y / edge),
                                         static_cast<std::int64_t>(p.z / edge)};
    };
    for (std::size_t i = 0; i < depth_.size(); ++i)
      if (depth_[i] >= 0) cells[cell(i)].push_back(i);
    using Order = std::tuple<std::int64_t, std::uint64_t, GridPoint, std::size_t>;
    std::vector<Order> order;
    for (std::size_t i = 0; i < depth_.size(); ++i) {
      if (leaf_depth_[i] <= depth) continue;
      const auto at = octant(i, depth);
      order.emplace_back((at[0] & 1) + 2 * (at[1] & 1) + 4 * (at[2] & 1), rank_of(cloud_.points[i]), cloud_.points[i],
                         i);
    }
    std::ranges::sort(order);
    for (const auto& [turn, rank, point, i] : order) {
      if (depth_[i] >= 0 || is_covered(i, cells, cell(i), spacing)) continue;
      depth_[i] = depth;
      cells[cell(i)].push_back(i);
    }
  }
  bool is_covered(std::size_t i, const Cells& cells, const std::array<std::int64_t, 3>& at, double spacing) const {
    for (int n = 0; n < 27; ++n) {
      const auto found = cells.find({at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1});
      if (found == cells.end()) continue;
      for (const std::size_t j : found->second)
        if (distance2(grid_.place(cloud_.points[i]), grid_.place(cloud_.points[j])) < spacing * spacing) return true;
    }
    return false;
  }

  const Cloud& cloud_;
  LevelGrid grid_;
  std::vector<int> leaf_depth_, depth_;
};

std::int32_t steps(double value) { return static_cast<std::int32_t>(std::lround(value)); }

Cloud surface(std::size_t n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Cloud cloud;
  while (cloud.points.size() < n) {
    const double x = unit(random), y = unit(random) * unit(random);
    cloud.points.push_back({steps(1e5 * x), steps(1e5 * y), steps(5e3 * std::sin(9 * x) * std::cos(7 * y))});
  }
  return cloud;
}

Cloud volume(std::size_t n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::int32_t> place(-700, 800);
  Cloud cloud{.points = {}, .scale = {0.1, 0.2, 0.05}};
  while (cloud.points.size() < n) cloud.points.push_back({place(random), place(random) / 2, place(random) * 2});
  return cloud;
}

/// Returns a cloud with half of its points at few places, one point far away, and the rest along a line.
Cloud clusters(std::size_t n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> bell(0, 1);
  Cloud cloud;
  cloud.points.push_back({1'900'000'000, -1'900'000'000, 0});
  while (cloud.points.size() < n) {
    const auto i = cloud.points.size();
    if (i % 2 == 0)
      cloud.points.push_back({steps(20 * bell(random)), 7, 7});
    else if (i % 3 == 0)
      cloud.points.push_back({5, 5, 5});
    else
      cloud.points.push_back({steps(1e6 * bell(random)), steps(1e6), 3});
  }
  return cloud;
}

TEST(LevelChoice, IsTheGreedyChoiceOfEachDepth) {
  for (const Cloud& cloud : {surface(330'000, 1), volume(140'000, 2), clusters(210'000, 3), surface(1000, 4)}) {
    Oracle oracle(cloud);
    const Result expected = oracle.levels();
    const Result got = run(cloud, 64 << 20, false);
    EXPECT_DOUBLE_EQ(got.spacing, expected.spacing);
    ASSERT_EQ(got.levels.size(), expected.levels.size());
    EXPECT_TRUE(got.levels == expected.levels);
  }
}

TEST(LevelChoice, IsTheSameForAnyMemoryThreadsAndOrder) {
  Cloud cloud = clusters(210'000, 5);
  const Result expected = run(cloud, 64 << 20, false);
  std::ranges::shuffle(cloud.points, std::mt19937_64(6));
  for (const unsigned threads : {1u, 3u}) {
    with_threads(threads, [&] {
      EXPECT_TRUE(run(cloud, 1 << 20, true).levels == expected.levels);
      EXPECT_TRUE(run(cloud, 16 << 20, true).levels == expected.levels);
    });
  }
}

TEST(LevelChoice, PutsAllPointsOfOnePlaceIntoTheRoot) {
  const Result got = run(Cloud{.points = std::vector<GridPoint>(200'000, GridPoint{3, 4, 5})}, 1 << 20, true);
  ASSERT_EQ(got.levels.size(), 200'000u);
  for (const Level& level : got.levels) ASSERT_EQ(level.depth, 0);
}

}  // namespace
}  // namespace pointsweep
