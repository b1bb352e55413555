// SPDX-License-Identifier: MIT
/// The region of a recall: points of the cloud that are read into memory again after the sweep.
#include <algorithm>
#include <cmath>
#include <utility>

#include "pointsweep/free_memory.h"
#include "pointsweep/sweep/recalled_points.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

/// Returns an upper bound of distance2() from `p` to any point of the box.
double farthest_distance2(const Box& b, Vec3 p) {
  const double dx = std::max(std::abs(b.lo.x - p.x), std::abs(b.hi.x - p.x));
  const double dy = std::max(std::abs(b.lo.y - p.y), std::abs(b.hi.y - p.y));
  const double dz = std::max(std::abs(b.lo.z - p.z), std::abs(b.hi.z - p.z));
  return (dx * dx + dy * dy) + dz * dz;
}

/// Finds the least distance from a place within which whole cells hold `count` points.
struct WholeCells {
  Vec3 place;
  std::uint64_t count;
  double reach2;  ///< squared distance that holds `count` points; infinite while too few points have been added
  /// For each cell, the squared distance to its farthest corner and the number of its points; ascending.
  std::vector<std::pair<double, std::uint64_t>> cells;

  void add(const std::vector<DroppedCell>& more) {
    for (const DroppedCell& cell : more)
      if (const double d2 = farthest_distance2(cell.box, place); d2 < reach2) cells.emplace_back(d2, cell.points);
    std::ranges::sort(cells);
    std::uint64_t points = 0;
    const auto last = std::ranges::find_if(cells, [&](const auto& cell) { return (points += cell.second) >= count; });
    if (last == cells.end()) return;
    reach2 = last->first;
    cells.erase(std::next(last), cells.end());
  }
};

}  // namespace

bool Region::collect(WantedPoints wanted) {
  PointCollector collector(stream_, frontier_, std::move(wanted));
  const bool fits = collector.run(slabs_at_once_);
  slabs_read_.add(collector.slabs_read());
  if (!fits) return false;
  std::vector<CollectedPoints> found = collector.take();
  std::vector<std::vector<std::unique_ptr<WindowCell>>> cells(found.size());
  parallel_for(found.size(), [&](std::size_t i, unsigned) {
    const std::vector<std::uint32_t>& held = held_[found[i].slab];
    found[i].keep_only([&](std::uint32_t n) { return !std::ranges::binary_search(held, found[i].index_in_slab[n]); });
    cells[i] = loader_.cells_of(found[i].slab, found[i].index_in_slab, found[i].records);
    free_memory_of(found[i].records);
  });
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (auto& cell : cells[i]) add(std::move(cell));
    std::vector<std::uint32_t>& held = held_[found[i].slab];
    const auto middle = held.insert(held.end(), found[i].index_in_slab.begin(), found[i].index_in_slab.end());
    std::inplace_merge(held.begin(), middle, held.end());
  }
  return true;
}

bool Region::touches_more_than(std::uint64_t count, Vec3 p, double reach2) const {
  std::uint64_t points = 0;
  for (std::uint32_t slab = 0; slab < held_.size(); ++slab) {
    if (distance2(stream_.slabs()[slab].box, p) > reach2) continue;
    for (const DroppedCell& cell : frontier_.dropped_of(slab))
      if (distance2(cell.box, p) <= reach2 && (points += cell.points) > count) return true;
  }
  return false;
}

/// Searches the nearest slab first, since the distance found there excludes most other slabs.
double Region::reach2_that_holds(Vec3 p, std::uint64_t count) const {
  const std::vector<Slab>& slabs = stream_.slabs();
  WholeCells found{p, count, Box::kInf, {}};
  const auto nearest = std::ranges::min_element(slabs, {}, [&](const Slab& slab) { return distance2(slab.box, p); });
  const auto first = static_cast<std::uint32_t>(nearest - slabs.begin());
  found.add(frontier_.dropped_of(first));
  std::vector<std::pair<double, std::uint32_t>> others;  // squared distance and number of a slab
  for (std::uint32_t slab = 0; slab < slabs.size(); ++slab)
    if (const double d2 = distance2(slabs[slab].box, p); slab != first && d2 <= found.reach2)
      others.emplace_back(d2, slab);
  std::ranges::sort(others);
  for (const auto& [d2, slab] : others) {
    if (d2 > found.reach2) break;
    found.add(frontier_.dropped_of(slab));
  }
  return found.reach2;
}

}  // namespace pointsweep
