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

bool holds_any(const WindowCell& cell, std::span<const NeededPlace> places) {
  return !places.empty() && std::any_of(cell.index_in_slab.begin(), cell.index_in_slab.end(), [&](std::uint32_t index) {
    return std::ranges::binary_search(places, index, {}, &NeededPlace::index_in_slab);
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
  const std::vector<std::uint32_t> slabs = slabs_to_read(balls, places);
  for (std::size_t first = 0; first < slabs.size(); first += slabs_at_once_) {
    std::vector<LoadedSlab> loaded(std::min(slabs_at_once_, slabs.size() - first));
    parallel_for(loaded.size(), [&](std::size_t i, unsigned) { loaded[i] = loader_.load(slabs[first + i], false); });
    for (std::size_t i = 0; i < loaded.size(); ++i) take(slabs[first + i], std::move(loaded[i]), balls, places);
    if (points_ > most_points) return false;
  }
  return true;
}

std::vector<std::uint32_t> Region::slabs_to_read(std::span<const NeededBalls> balls,
                                                 std::span<const NeededPlace> places) const {
  std::vector<std::uint8_t> wanted(present_.size());
  parallel_for(present_.size(), [&](std::size_t s, unsigned) {
    stop_if_cancelled();
    const auto slab = static_cast<std::uint32_t>(s);
    const auto is_needed = [&](const DroppedCell& cell) {
      return !is_present(slab, cell.number) && any_touches(balls, cell.box);
    };
    const std::vector<DroppedCell>& cells = frontier_.dropped_of(slab);
    wanted[s] = !places_of(slab, places).empty() ||
                (any_touches(balls, stream_.slabs()[s].box) && std::any_of(cells.begin(), cells.end(), is_needed));
  });
  std::vector<std::uint32_t> slabs;
  for (std::uint32_t slab = 0; slab < wanted.size(); ++slab)
    if (wanted[slab] != 0) slabs.push_back(slab);
  return slabs;
}

void Region::take(std::uint32_t slab, LoadedSlab loaded, std::span<const NeededBalls> balls,
                  std::span<const NeededPlace> places) {
  present_[slab].resize(loaded.cells.size());
  const std::span<const NeededPlace> here = places_of(slab, places);
  for (auto& cell : loaded.cells) {
    if (present_[slab][cell->number]) continue;
    const bool needed =
        any_touches(balls, cell->cell.box) && !frontier_.is_superfluous(cell->cell.box, cell->cell.lowest_row);
    if (needed || holds_any(*cell, here)) admit(std::move(cell));
  }
  ++slabs_read_;
}

void Region::admit(std::unique_ptr<WindowCell> cell) {
  present_[cell->slab][cell->number] = true;
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
