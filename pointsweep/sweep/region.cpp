// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/region.h"

#include <algorithm>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

bool any_touches(std::span<const NeededBalls> balls, const Box& box) {
  return std::any_of(balls.begin(), balls.end(), [&](const NeededBalls& b) { return b.touch(box); });
}

std::span<const NeededPlace> places_of(std::uint32_t slab, std::span<const NeededPlace> places) {
  const auto here = std::ranges::equal_range(places, slab, {}, &NeededPlace::slab);
  return {here.begin(), here.end()};
}

bool holds_any(std::span<const CutPoint> points, std::span<const NeededPlace> places) {
  return !places.empty() && std::any_of(points.begin(), points.end(), [&](const CutPoint& point) {
    return std::ranges::binary_search(places, point.index, {}, &NeededPlace::index_in_slab);
  });
}

/// The cells nearest to a place that hold `count` points together.
struct NearestCells {
  Vec3 place;
  std::uint64_t count;
  double reach2;  ///< of the last of them; infinite while there are too few points
  std::vector<std::pair<double, std::uint64_t>> cells;  ///< squared distance, points; ascending

  void add(const std::vector<DroppedCell>& more) {
    for (const DroppedCell& cell : more)
      if (const double d2 = distance2(cell.box, place); d2 < reach2) cells.emplace_back(d2, cell.points);
    std::ranges::sort(cells);
    std::uint64_t points = 0;
    const auto last = std::ranges::find_if(cells, [&](const auto& cell) { return (points += cell.second) >= count; });
    if (last == cells.end()) return;
    reach2 = last->first;
    cells.erase(std::next(last), cells.end());
  }
};

}  // namespace

void NeededBalls::add(Vec3 center, double ball_reach2) {
  centers.include(center);
  reach2 = std::max(reach2, ball_reach2);
  balls.push_back({center, ball_reach2});
}

bool NeededBalls::touch(const Box& box) const {
  if (balls.empty() || distance2(centers, box) > reach2) return false;
  return std::any_of(balls.begin(), balls.end(),
                     [&](const Ball& ball) { return distance2(box, ball.center) <= ball.reach2; });
}

bool Region::load(std::span<const NeededBalls> balls, std::span<const NeededPlace> places, std::uint64_t most_points) {
  const std::vector<MissingCells> missing = missing_cells(balls, places);
  for (std::size_t first = 0; first < missing.size(); first += slabs_at_once_) {
    std::vector<LoadedSlab> loaded(std::min(slabs_at_once_, missing.size() - first));
    parallel_for(loaded.size(), [&](std::size_t i, unsigned) { loaded[i] = read(missing[first + i]); });
    for (LoadedSlab& slab : loaded)
      for (auto& cell : slab.cells) admit(std::move(cell));
    slabs_read_ += loaded.size();
    if (points_ > most_points) return false;
  }
  return true;
}

std::vector<Region::MissingCells> Region::missing_cells(std::span<const NeededBalls> balls,
                                                        std::span<const NeededPlace> places) const {
  std::vector<MissingCells> missing(present_.size());
  parallel_for(present_.size(), [&](std::size_t s, unsigned) {
    stop_if_cancelled();
    const auto slab = static_cast<std::uint32_t>(s);
    missing[s] = {slab, {}, places_of(slab, places)};
    if (!any_touches(balls, stream_.slabs()[s].box)) return;
    for (const DroppedCell& cell : frontier_.dropped_of(slab))
      if (!is_present(slab, cell.number) && any_touches(balls, cell.box)) missing[s].numbers.push_back(cell.number);
    std::ranges::sort(missing[s].numbers);
  });
  std::erase_if(missing, [](const MissingCells& m) { return m.numbers.empty() && m.places.empty(); });
  return missing;
}

LoadedSlab Region::read(const MissingCells& missing) const {
  return loader_.load_cells(missing.slab, [&](std::uint32_t number, std::span<const CutPoint> points) {
    return std::ranges::binary_search(missing.numbers, number) ||
           (!is_present(missing.slab, number) && holds_any(points, missing.places));
  });
}

void Region::admit(std::unique_ptr<WindowCell> cell) {
  std::vector<bool>& present = present_[cell->slab];
  if (present.size() <= cell->number) present.resize(cell->number + 1);
  present[cell->number] = true;
  directory_.add(size(), &cell->cell);
  points_ += cell->cell.size();
  views_.push_back(cell->view());
  cells_.push_back(std::move(cell));
}

void Region::missing_near(const Box& box, double reach2, std::vector<Box>& out) const {
  out.clear();
  for (std::uint32_t slab = 0; slab < present_.size(); ++slab) {
    if (distance2(stream_.slabs()[slab].box, box) > reach2) continue;
    for (const DroppedCell& cell : frontier_.dropped_of(slab))
      if (distance2(cell.box, box) <= reach2 && !is_present(slab, cell.number)) out.push_back(cell.box);
  }
}

/// The nearest slab first: what it gives leaves few other slabs to look at.
double Region::reach2_of_cells(Vec3 p, std::uint64_t count) const {
  const std::vector<Slab>& slabs = stream_.slabs();
  NearestCells found{p, count, Box::kInf, {}};
  const auto nearest = std::ranges::min_element(slabs, {}, [&](const Slab& slab) { return distance2(slab.box, p); });
  const auto first = static_cast<std::uint32_t>(nearest - slabs.begin());
  found.add(frontier_.dropped_of(first));
  std::vector<std::pair<double, std::uint32_t>> others;  // squared distance, slab
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
