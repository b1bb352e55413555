// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/recalled_points.h"

#include <algorithm>
#include <map>
#include <stdexcept>

#include "pointsweep/cancellation.h"
#include "pointsweep/sweep/apply_step.h"
#include "pointsweep/sweep/expected_reach.h"
#include "pointsweep/sweep/stopwatch.h"
#include "pointsweep/sweep/truncate_lists.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

/// The cells that a point still lacks are loaded so many points at a time, and so many times more each time: the reach
/// found among a part of the cells may be that of a ball which touches a large part of the cloud.
constexpr std::uint64_t kFirstPoints = 4096, kMorePoints = 4;

/// Points of the cells that are loaded around a point because it is expected to need them. Outliers would expect all of
/// a dense surface that they are near to.
constexpr std::uint64_t kMostExpected = 8192;

/// Values of CellState::reached.
constexpr std::uint8_t kReachedNow = 1, kInLevel = 2;

double to_nearest(const std::vector<Box>& boxes, Vec3 p) {
  double nearest = Box::kInf;
  for (const Box& box : boxes) nearest = std::min(nearest, distance2(box, p));
  return nearest;
}

/// Leaves those of the lists whose numbers `kept` names, which ascend.
void keep_lists_of(const std::vector<std::uint32_t>& kept, CellNeighbors& lists) {
  std::uint32_t end = 0;
  for (std::uint32_t n = 0; n < kept.size(); ++n) {
    const std::uint32_t begin = lists.begin[kept[n]], behind = lists.begin[kept[n] + 1];
    std::copy(lists.refs.begin() + begin, lists.refs.begin() + behind, lists.refs.begin() + end);
    lists.begin[n] = end;
    end += behind - begin;
  }
  lists.begin[kept.size()] = end;
  lists.begin.resize(kept.size() + 1);
  lists.refs.resize(end);
}

}  // namespace

bool RecalledPoints::gather(std::span<const DeferredPoint> points) {
  alone_ = points.size() == 1;
  if (!load_own_balls(points)) return false;
  place(points);
  for (std::uint32_t level = last_level();; --level) {
    if (!find_level(level)) return false;
    if (level == 0) return true;
    begin_level(level - 1);
  }
}

void RecalledPoints::finish(Sink& sink) {
  for (std::uint32_t step = 0; step <= last_level(); ++step) {
    const auto takes_step = [&](const CellState& cell) {
      return std::any_of(cell.listed.begin(), cell.listed.end(), [&](const Listed& l) { return l.level >= step; });
    };
    for_cells(cells_with(takes_step), [&](std::uint32_t slot, Worker& worker) { take_step(slot, step, worker, sink); });
  }
}

template <class Has>
std::vector<std::uint32_t> RecalledPoints::cells_with(Has has) const {
  std::vector<std::uint32_t> slots;
  for (std::uint32_t slot = 0; slot < cells_.size(); ++slot)
    if (has(cells_[slot])) slots.push_back(slot);
  return slots;
}

template <class Work>
void RecalledPoints::for_cells(const std::vector<std::uint32_t>& slots, Work work) {
  parallel_for(slots.size(), [&](std::size_t i, unsigned worker) {
    stop_if_cancelled();
    work(slots[i], workers_[worker]);
  });
}

/// The balls of the deferred points themselves, and the cells these are in.
bool RecalledPoints::load_own_balls(std::span<const DeferredPoint> points) {
  std::vector<NeededPlace> places;
  for (const DeferredPoint& p : points) places.push_back({p.slab, p.index_in_slab});
  std::ranges::sort(places);
  std::vector<double> reach2(points.size());
  parallel_for(points.size(), [&](std::size_t i, unsigned) {
    stop_if_cancelled();
    reach2[i] = std::min(points[i].reach2, region_.reach2_of_cells(points[i].position, first_points()));
  });
  constexpr std::size_t kTogether = 16;
  std::vector<NeededBalls> balls;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % kTogether == 0) balls.emplace_back();
    balls.back().add(points[i].position, reach2[i]);
  }
  return load(balls, places);
}

/// Loads what the cells need, but for what they have.
bool RecalledPoints::load_needed() {
  std::vector<NeededBalls> needed;
  for (CellState& cell : cells_) {
    if (!cell.needed.balls.empty()) needed.push_back(std::move(cell.needed));
    cell.needed = {};
  }
  return needed.empty() || load(needed, {});
}

bool RecalledPoints::load(std::span<const NeededBalls> balls, std::span<const NeededPlace> places) {
  const bool fitted = region_.load(balls, places, alone_ ? ~std::uint64_t{0} : memory_.bytes / point_bytes_);
  for (std::size_t slot = cells_.size(); slot < region_.size(); ++slot) {
    const Cell& cell = region_.at(static_cast<std::uint32_t>(slot)).cell;
    cells_.emplace_back();
    cells_.back().reached.resize(cell.size(), 0);
    cells_.back().leaf_reach = expected_reaches(cell, plan_.neighborhood);
  }
  return fitted;
}

/// Finds the deferred points in their cells.
void RecalledPoints::place(std::span<const DeferredPoint> points) {
  std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> step_of;  // by slab and place in it
  for (const DeferredPoint& p : points) step_of[p.slab][p.index_in_slab] = p.step;
  std::size_t placed = 0;
  for (std::uint32_t slot = 0; slot < region_.size(); ++slot) {
    const WindowCell& cell = region_.at(slot);
    const auto of_slab = step_of.find(cell.slab);
    if (of_slab == step_of.end()) continue;
    for (std::uint32_t i = 0; i < cell.cell.size(); ++i) {
      const auto found = of_slab->second.find(cell.index_in_slab[i]);
      if (found == of_slab->second.end()) continue;
      CellState& state = cells_[slot];
      state.reached[i] = kInLevel;
      state.pending.push_back({i, kFirstPoints});
      state.counted_from.emplace_back(i, found->second);
      ++placed;
    }
  }
  if (placed != points.size()) throw std::logic_error("a deferred point is in no cell of its slab");
}

/// The points that the lists of the level behind it name come into the level.
void RecalledPoints::begin_level(std::uint32_t level) {
  pending_bytes_ = 0;
  parallel_for(cells_.size(), [&](std::size_t slot, unsigned worker) {
    stop_if_cancelled();
    CellState& cell = cells_[slot];
    for (std::uint32_t i = 0; i < cell.reached.size(); ++i) {
      if (cell.reached[i] != kReachedNow) continue;
      cell.reached[i] = kInLevel;
      cell.pending.push_back({i, kFirstPoints});
    }
    pending_bytes_ += cell.pending.size() * (sizeof(Pending) + sizeof(NeededBalls::Ball));
    if (!cell.pending.empty()) need_expected(static_cast<std::uint32_t>(slot), level, workers_[worker]);
  });
}

bool RecalledPoints::find_level(std::uint32_t level) {
  for (;;) {
    if (!load_needed() || !fits()) return false;
    const std::vector<std::uint32_t> slots = cells_with([](const CellState& cell) { return !cell.pending.empty(); });
    if (slots.empty()) return true;
    for_cells(slots, [&](std::uint32_t slot, Worker& worker) { find_lists(slot, level, worker); });
  }
}

/// What the points of a cell are expected to need for themselves, and the levels that follow around them: otherwise the
/// same slabs would be read again for each level. Not more than a cell's width of it.
void RecalledPoints::need_expected(std::uint32_t slot, std::uint32_t level, Worker& worker) {
  CellState& state = cells_[slot];
  const Cell& cell = region_.at(slot).cell;
  const double wide = cell.box.diagonal();
  // 0 where the density says nothing: the search will tell.
  const auto expected2 = [&](const Pending& p) {
    const double reach = state.leaf_reach[p.point / kLeafCapacity];
    const double expected = reach < wide / 4 ? std::min((level + 1) * reach, wide) : 0;
    return expected * expected;
  };
  Box around;
  double farthest2 = 0;
  for (const Pending& p : state.pending) {
    around.include(cell.position(p.point));
    farthest2 = std::max(farthest2, expected2(p));
  }
  region_.missing_near(around, farthest2, worker.dropped);
  if (worker.dropped.empty()) return;
  for (const Pending& p : state.pending) {
    const Vec3 position = cell.position(p.point);
    const double reach2 = expected2(p);
    if (reach2 > 0 && to_nearest(worker.dropped, position) <= reach2)
      state.needed.add(position, std::min(reach2, region_.reach2_of_cells(position, kMostExpected)));
  }
}

/// Lists of the first of `points`, in worker.neighbors. Returns how many.
std::size_t RecalledPoints::search(std::uint32_t slot, std::span<const std::uint32_t> points, Worker& worker) {
  const Stopwatch watch(worker.search_seconds);
  return search_chosen(region_.directory(), slot, points, most_listed(), plan_.neighborhood, worker.search,
                       worker.neighbors);
}

/// Of the pending points. Those that need more than there is in memory stay pending.
void RecalledPoints::find_lists(std::uint32_t slot, std::uint32_t level, Worker& worker) {
  CellState& state = cells_[slot];
  const std::vector<Pending> pending = std::move(state.pending);
  state.pending.clear();
  std::vector<std::uint32_t> points;
  for (const Pending& p : pending) points.push_back(p.point);
  for (std::size_t first = 0, end = 0; first < points.size(); first = end) {
    end = first + search(slot, std::span(points).subspan(first), worker);
    const std::vector<std::uint32_t> certain = certify(slot, std::span(pending).subspan(first, end - first), worker);
    if (certain.size() < end - first) keep_lists_of(certain, worker.neighbors);
    std::vector<std::uint32_t> listed;
    for (const std::uint32_t n : certain) listed.push_back(points[first + n]);
    if (!listed.empty()) keep(slot, level, std::move(listed), worker);
  }
}

/// The numbers of those of the points just searched whose balls hold nothing that is not in memory.
std::vector<std::uint32_t> RecalledPoints::certify(std::uint32_t slot, std::span<const Pending> searched,
                                                   Worker& worker) {
  CellState& state = cells_[slot];
  const Cell& cell = region_.at(slot).cell;
  const std::vector<double>& reach2 = worker.neighbors.reach2;
  Box around;
  for (const Pending& p : searched) around.include(cell.position(p.point));
  region_.missing_near(around, *std::max_element(reach2.begin(), reach2.end()), worker.dropped);
  std::vector<std::uint32_t> certain;
  for (std::uint32_t n = 0; n < searched.size(); ++n) {
    const Vec3 position = cell.position(searched[n].point);
    const double missing2 = to_nearest(worker.dropped, position);
    if (worker.dropped.empty() || missing2 > reach2[n]) {
      certain.push_back(n);
      continue;
    }
    // What was found among a part of the cells may be far too long: the nearest cells come first, more each time.
    const double nearest2 = region_.reach2_of_cells(position, searched[n].points);
    const double needed2 = std::min(reach2[n], std::max(nearest2, missing2));
    state.needed.add(position, needed2);
    state.pending.push_back({searched[n].point, kMorePoints * searched[n].points});
  }
  return certain;
}

/// Applies the rule of the plan to worker.neighbors.
void RecalledPoints::truncate_found_lists(std::uint32_t slot, std::span<const std::uint32_t> points, Worker& worker) {
  if (!plan_.neighborhood.rule) return;
  WindowCell& cell = region_.at(slot);
  std::vector<std::byte*> columns;
  for (auto& column : cell.columns) columns.push_back(column.empty() ? nullptr : column.data());
  worker.chosen.take(plan_, cell.cell, points, columns);
  truncate_lists(plan_, worker.chosen.view(), points.size(), region_.slots(), worker.neighbors);
}

void RecalledPoints::keep(std::uint32_t slot, std::uint32_t level, std::vector<std::uint32_t> points, Worker& worker) {
  truncate_found_lists(slot, points, worker);
  if (level > 0) reach_neighbors(worker.neighbors);
  Listed listed{.level = level, .points = std::move(points), .lists = {}, .has_lists = true};
  const std::uint64_t bytes = worker.neighbors.list_bytes() + listed.points.size() * sizeof(std::uint32_t);
  if (alone_ && list_bytes_ + bytes + region_.points() * point_bytes_ > memory_.bytes) {
    listed.has_lists = false;
  } else {
    list_bytes_ += bytes;
    listed.lists.begin = worker.neighbors.begin;
    listed.lists.refs = worker.neighbors.refs;
  }
  cells_[slot].listed.push_back(std::move(listed));
}

/// The points that lists name are to come into the next level.
void RecalledPoints::reach_neighbors(const CellNeighbors& lists) {
  for (const NeighborRef ref : lists.refs) {
    const std::atomic_ref<std::uint8_t> reached(cells_[slot_of(ref)].reached[index_of(ref)]);
    if (reached.load(std::memory_order_relaxed) == 0) reached.store(kReachedNow, std::memory_order_relaxed);
  }
}

void RecalledPoints::take_step(std::uint32_t slot, std::uint32_t step, Worker& worker, Sink& sink) {
  place_cell_columns(plan_, step, region_.at(slot), worker);
  const auto use = [&](std::uint32_t level, std::span<const std::uint32_t> points, const CellNeighbors& lists) {
    if (level == last_level()) return apply_deferred(slot, step, points, lists, worker, sink);
    apply_step_to(plan_, step, region_.at(slot), points, lists, region_.slots(), worker, worker.halo,
                  [](std::size_t) {});
  };
  for (const Listed& listed : cells_[slot].listed) {
    if (listed.level < step) continue;
    const std::span<const std::uint32_t> points(listed.points);
    if (listed.has_lists) {
      use(listed.level, points, listed.lists);
      continue;
    }
    for (std::size_t first = 0, end = 0; first < points.size(); first = end) {
      end = first + search(slot, points.subspan(first), worker);
      truncate_found_lists(slot, points.subspan(first, end - first), worker);
      use(listed.level, points.subspan(first, end - first), worker.neighbors);
    }
  }
}

/// Of a deferred point the sweep has counted what steps it had taken before. What the step has made of the others,
/// which take it for the second time, is not counted again.
void RecalledPoints::apply_deferred(std::uint32_t slot, std::uint32_t step, std::span<const std::uint32_t> points,
                                    const CellNeighbors& lists, Worker& worker, Sink& sink) const {
  const auto& counted_from = cells_[slot].counted_from;
  for (const bool counted : {true, false}) {
    std::vector<std::uint32_t> chosen, numbers;
    for (std::uint32_t n = 0; n < points.size(); ++n) {
      const auto at =
          std::ranges::lower_bound(counted_from, points[n], {}, &std::pair<std::uint32_t, std::uint32_t>::first);
      if ((step >= at->second) != counted) continue;
      chosen.push_back(points[n]);
      numbers.push_back(n);
    }
    if (chosen.empty()) continue;
    CellNeighbors some;
    if (chosen.size() < points.size()) {
      some = lists;
      keep_lists_of(numbers, some);
    }
    const CellNeighbors& chosen_lists = chosen.size() < points.size() ? some : lists;
    StageTally& tally = counted ? worker.tally : worker.halo;
    apply_step_to(plan_, step, region_.at(slot), chosen, chosen_lists, region_.slots(), worker, tally,
                  [&](std::size_t first) {
                    if (counted) count_degenerate(step, worker);
                    if (step == last_level())
                      hand_over(slot, std::span(chosen).subspan(first, worker.chosen.size()), worker, sink);
                  });
  }
}

void RecalledPoints::count_degenerate(std::uint32_t step, Worker& worker) const {
  for_each_marked(plan_, step, worker.tally, [&](std::size_t stage, std::size_t i) {
    worker.tally.degenerate[stage].add(worker.chosen.rows()[i]);
  });
}

/// The deferred points in worker.chosen, which have taken the last step.
void RecalledPoints::hand_over(std::uint32_t slot, std::span<const std::uint32_t> points, Worker& worker,
                               Sink& sink) const {
  const WindowCell& cell = region_.at(slot);
  collect_results(plan_, worker.chosen.columns(), points.size(), worker.results);
  std::vector<std::uint32_t> index_in_slab;
  for (const std::uint32_t i : points) index_in_slab.push_back(cell.index_in_slab[i]);
  sink.recalled({cell.slab, index_in_slab.data(), worker.chosen.rows(), worker.results.data(), points.size()});
}

}  // namespace pointsweep
