// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/recalled_points.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "pointsweep/cancellation.h"
#include "pointsweep/sweep/worker.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

/// Values of CellState::reached: kReachedNow if the point will be in the next level, kInLevel if it is in a level, 0 if
/// no list names it yet.
constexpr std::uint8_t kReachedNow = 1, kInLevel = 2;

/// A ball may hold many points if the cells that it touches hold more than kFewPoints + k * kFewForNeighbor.
constexpr std::uint64_t kFewPoints = 8192, kFewForNeighbor = 128;
/// Reach of a BallCover in multiples of the radius of a ball: the diagonal of a cube whose side is three radii.
constexpr double kCoverReach = 5.2;

/// kBallBytes: bytes of an element of WantedPoints::balls while points are collected, without its distances.
/// kWholeBallBytes: bytes of an element of WantedPoints::whole_balls and of the cells that it marks in the BallCover.
constexpr std::uint64_t kBallBytes = 2 * sizeof(Ball) + sizeof(std::vector<double>) + 8 * 24;
constexpr std::uint64_t kWholeBallBytes = 2 * sizeof(Ball) + 64;

double sum_of_roots_squared(double a2, double b2) {
  const double sum = (std::sqrt(a2) + std::sqrt(b2)) * (1 + 1e-12);  // an upper bound in spite of rounding
  return sum * sum;
}

void lower_to(double& bound, double value) {
  const std::atomic_ref<double> at(bound);
  double now = at.load(std::memory_order_relaxed);
  while (value < now && !at.compare_exchange_weak(now, value, std::memory_order_relaxed)) {
  }
}

}  // namespace

bool RecalledPoints::gather(std::span<const DeferredPoint> points) {
  alone_ = points.size() == 1;
  if (!collect_deferred(points)) return false;
  for (std::uint32_t level = last_level();; --level) {
    find_level(level);
    if (!fits()) return false;
    if (level == 0) return true;
    if (!begin_next_level()) return false;
  }
}

std::size_t RecalledPoints::finish(Sink& sink) {
  for (std::uint32_t step = 0; step <= last_level(); ++step) {
    const auto takes_step = [&](const CellState& cell) {
      return std::any_of(cell.listed.begin(), cell.listed.end(), [&](const Listed& l) { return l.level >= step; });
    };
    for_cells(cells_with(takes_step), [&](std::uint32_t slot, Worker& worker) { take_step(slot, step, worker, sink); });
  }
  std::size_t deferred = 0;
  for (const CellState& cell : cells_) deferred += cell.counted_from.size();
  return deferred;
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

/// Returns whether the cells within `widths` times the radius of the ball hold many more points than a neighbourhood
/// (kFewPoints). Returns false without a limit k, since all points of the ball are then neighbours.
bool RecalledPoints::may_hold_many(const Ball& ball, double widths) const {
  const std::uint64_t few = kFewPoints + kFewForNeighbor * plan_.neighborhood.k;
  return plan_.neighborhood.k != Neighborhood::kUnlimited &&
         region_.touches_more_than(few, ball.center, widths * widths * ball.reach2);
}

/// Returns the ball, or a smaller ball that contains whole cells with at least k + 1 points: k neighbours and the
/// point.
Ball RecalledPoints::smaller(const Ball& ball) const {
  const double reach2 = region_.reach2_that_holds(ball.center, std::uint64_t{plan_.neighborhood.k} + 1);
  return {ball.center, std::min(ball.reach2, reach2)};
}

/// Collects the deferred points and their neighbourhoods.
bool RecalledPoints::collect_deferred(std::span<const DeferredPoint> points) {
  WantedPoints wanted;
  for (const DeferredPoint& p : points) wanted.places.push_back({p.slab, p.index_in_slab});
  std::ranges::sort(wanted.places);
  std::vector<Ball> balls(points.size());
  parallel_for(points.size(), [&](std::size_t i, unsigned) {
    stop_if_cancelled();
    balls[i] = {points[i].position, std::min(points[i].reach2, plan_.neighborhood.radius2())};
    if (may_hold_many(balls[i], 1)) balls[i] = smaller(balls[i]);
  });
  (plan_.neighborhood.k == Neighborhood::kUnlimited ? wanted.whole_balls : wanted.balls) = balls;
  if (!collect(std::move(wanted))) return false;
  place(points, balls);
  return true;
}

bool RecalledPoints::collect(WantedPoints wanted) {
  wanted.nearest = std::uint64_t{plan_.neighborhood.k} + 1;
  pending_bytes_ = wanted.balls.size() * (kBallBytes + wanted.nearest * sizeof(double)) +
                   wanted.whole_balls.size() * kWholeBallBytes;
  if (!fits()) return false;
  wanted.most_points = alone_ ? ~std::uint64_t{0} : (memory_.bytes - bytes()) / (point_bytes_ + record_bytes_);
  const bool fitted = region_.collect(std::move(wanted));
  for (std::size_t slot = cells_.size(); slot < region_.slot_count(); ++slot) {
    const std::size_t points = region_.at(static_cast<std::uint32_t>(slot)).cell.size();
    cells_.emplace_back();
    cells_.back().reached.resize(points, 0);
    cells_.back().bound2.resize(points, Box::kInf);
  }
  pending_bytes_ = 0;
  return fitted;
}

/// Queues the deferred points in their cells.
void RecalledPoints::place(std::span<const DeferredPoint> points, std::span<const Ball> balls) {
  // Numbers of `points` by slab and index in the slab.
  std::map<std::uint32_t, std::map<std::uint32_t, std::size_t>> by_place;
  for (std::size_t n = 0; n < points.size(); ++n) by_place[points[n].slab][points[n].index_in_slab] = n;
  std::size_t placed = 0;
  for (std::uint32_t slot = 0; slot < region_.slot_count(); ++slot) {
    const WindowCell& cell = region_.at(slot);
    const auto of_slab = by_place.find(cell.slab);
    if (of_slab == by_place.end()) continue;
    for (std::uint32_t i = 0; i < cell.cell.size(); ++i) {
      const auto found = of_slab->second.find(cell.index_in_slab[i]);
      if (found == of_slab->second.end()) continue;
      CellState& state = cells_[slot];
      state.reached[i] = kInLevel;
      state.bound2[i] = balls[found->second].reach2;
      state.pending.push_back(i);
      state.counted_from.emplace_back(i, points[found->second].step);
      ++placed;
    }
  }
  if (placed != points.size()) throw std::logic_error("a deferred point is not where the sweep has found it");
}

/// Adds the points that the lists name and that are in no level yet to the preceding level, and collects the points
/// that the searches of these points need.
bool RecalledPoints::begin_next_level() {
  for (std::uint32_t slot = 0; slot < cells_.size(); ++slot) {
    CellState& cell = cells_[slot];
    for (std::uint32_t i = 0; i < cell.reached.size(); ++i) {
      if (cell.reached[i] != kReachedNow) continue;
      cell.reached[i] = kInLevel;
      cell.bound2[i] = std::min(cell.bound2[i], plan_.neighborhood.radius2());
      cell.pending.push_back(i);
    }
  }
  bound_by_points_in_memory();
  WantedPoints wanted;
  for (std::uint32_t slot = 0; slot < cells_.size(); ++slot)
    for (const std::uint32_t i : cells_[slot].pending)
      wanted.whole_balls.push_back({region_.at(slot).cell.position(i), cells_[slot].bound2[i]});
  separate_large(wanted);
  return (wanted.whole_balls.empty() && wanted.balls.empty()) || collect(std::move(wanted));
}

/// Moves balls that may contain many points from `whole_balls` to `balls`, for which only the nearest points are
/// collected.
void RecalledPoints::separate_large(WantedPoints& wanted) const {
  std::vector<std::uint8_t> is_large(wanted.whole_balls.size());
  parallel_for(is_large.size(), [&](std::size_t i, unsigned) {
    Ball& ball = wanted.whole_balls[i];
    is_large[i] = may_hold_many(ball, kCoverReach);
    if (is_large[i]) ball = smaller(ball);
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < is_large.size(); ++i) {
    if (is_large[i])
      wanted.balls.push_back(wanted.whole_balls[i]);
    else
      wanted.whole_balls[kept++] = wanted.whole_balls[i];
  }
  wanted.whole_balls.resize(kept);
}

/// Lowers the bounds of pending points by a search among the points in memory: the neighbourhood among all points never
/// reaches farther.
void RecalledPoints::bound_by_points_in_memory() {
  const std::vector<std::uint32_t> slots = cells_with([](const CellState& cell) { return !cell.pending.empty(); });
  for_cells(slots, [&](std::uint32_t slot, Worker& worker) {
    CellState& cell = cells_[slot];
    for (CellSubset rest = cell.pending; rest.size() > 0;) {
      const std::uint32_t found = lists_.find(slot, rest, worker);
      for (std::uint32_t n = 0; n < found; ++n)
        cell.bound2[rest[n]] = std::min(cell.bound2[rest[n]], worker.neighbors.reach2[n]);
      rest = rest.from(found);
    }
  });
}

void RecalledPoints::find_level(std::uint32_t level) {
  const std::vector<std::uint32_t> slots = cells_with([](const CellState& cell) { return !cell.pending.empty(); });
  for_cells(slots, [&](std::uint32_t slot, Worker& worker) { find_lists(slot, level, worker); });
}

/// Finds the lists of the pending points of a cell.
void RecalledPoints::find_lists(std::uint32_t slot, std::uint32_t level, Worker& worker) {
  const std::vector<std::uint32_t> pending = std::move(cells_[slot].pending);
  cells_[slot].pending.clear();
  for (CellSubset rest = pending; rest.size() > 0;) {
    const CellSubset listed = rest.part(0, lists_.find(slot, rest, worker));
    expect_complete(slot, listed, worker.neighbors);
    lists_.truncate(region_.at(slot), listed, worker);
    keep(slot, level, listed, worker);
    rest = rest.from(listed.size());
  }
}

/// Throws if a neighbourhood reaches beyond its bound, or has fewer than k points although its bound is shorter than
/// the radius. Within its bound a neighbourhood is complete, because the region holds all points within the bound.
void RecalledPoints::expect_complete(std::uint32_t slot, const CellSubset& points, const CellNeighbors& lists) const {
  const Cell& cell = region_.at(slot).cell;
  for (std::uint32_t n = 0; n < points.size(); ++n) {
    const double bound2 = cells_[slot].bound2[points[n]];
    const std::uint32_t count = lists.begin[n + 1] - lists.begin[n];
    bool complete = bound2 == plan_.neighborhood.radius2();
    if (!complete && count == plan_.neighborhood.k) {
      const NeighborRef last = lists.refs[lists.begin[n + 1] - 1];
      complete = distance2(cell.position(points[n]), region_.at(slot_of(last)).cell.position(index_of(last))) <= bound2;
    }
    if (!complete) throw std::logic_error("the neighbourhood of a recalled point reaches beyond its bound");
  }
}

void RecalledPoints::keep(std::uint32_t slot, std::uint32_t level, const CellSubset& points, Worker& worker) {
  if (level > 0) bound_neighbors(slot, points, worker.neighbors);
  Listed listed{.level = level, .points = {}, .lists = {}, .has_lists = true};
  for (std::uint32_t n = 0; n < points.size(); ++n) listed.points.push_back(points[n]);
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

/// Gives each point that the lists name a bound of its neighbourhood, for the search of the preceding level.
void RecalledPoints::bound_neighbors(std::uint32_t slot, const CellSubset& points, const CellNeighbors& lists) {
  for (std::uint32_t n = 0; n < points.size(); ++n) {
    const Vec3 p = region_.at(slot).cell.position(points[n]);
    for (std::uint32_t j = lists.begin[n]; j < lists.begin[n + 1]; ++j) {
      const std::uint32_t other = slot_of(lists.refs[j]), i = index_of(lists.refs[j]);
      const double distance = distance2(p, region_.at(other).cell.position(i));
      lower_to(cells_[other].bound2[i], sum_of_roots_squared(distance, lists.reach2[n]));
      const std::atomic_ref<std::uint8_t> reached(cells_[other].reached[i]);
      if (reached.load(std::memory_order_relaxed) == 0) reached.store(kReachedNow, std::memory_order_relaxed);
    }
  }
}

void RecalledPoints::take_step(std::uint32_t slot, std::uint32_t step, Worker& worker, Sink& sink) {
  WindowCell& cell = region_.at(slot);
  place_cell_columns(plan_, step, cell, worker);
  const auto apply = [&](std::uint32_t level, const CellSubset& points, const CellNeighbors& lists) {
    if (level == last_level()) return apply_deferred(slot, step, points, lists, worker, sink);
    apply_step(plan_, step, cell.cell, points, lists, region_.slots(), worker, worker.halo, [](const CellSubset&) {});
  };
  for (const Listed& listed : cells_[slot].listed) {
    if (listed.level < step) continue;
    CellSubset rest = listed.points;
    if (listed.has_lists) {
      apply(listed.level, rest, listed.lists);
      continue;
    }
    while (rest.size() > 0) {
      const CellSubset found = rest.part(0, lists_.find(slot, rest, worker));
      lists_.truncate(cell, found, worker);
      apply(listed.level, found, worker.neighbors);
      rest = rest.from(found.size());
    }
  }
}

/// Applies a step to deferred points. Counts degenerate results, except in steps that a point has already taken in the
/// sweep, which counted them.
void RecalledPoints::apply_deferred(std::uint32_t slot, std::uint32_t step, const CellSubset& points,
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
    worker.chosen_lists = lists;
    keep_lists_of(numbers, worker.chosen_lists);
    apply_step(plan_, step, region_.at(slot).cell, chosen, worker.chosen_lists, region_.slots(), worker,
               counted ? worker.tally : worker.halo, [&](const CellSubset& part) {
                 if (counted) count_degenerate(step, worker);
                 if (step == last_level()) hand_over(slot, part, worker, sink);
               });
  }
}

void RecalledPoints::count_degenerate(std::uint32_t step, Worker& worker) const {
  for_each_marked(plan_, step, worker.tally, [&](std::size_t stage, std::size_t i) {
    worker.tally.degenerate[stage].add(worker.chosen.rows()[i]);
  });
}

/// Delivers the results of the deferred points in worker.chosen, which have taken the last step.
void RecalledPoints::hand_over(std::uint32_t slot, const CellSubset& points, Worker& worker, Sink& sink) const {
  const WindowCell& cell = region_.at(slot);
  collect_results(plan_, worker.chosen.columns(), points.size(), worker.results);
  std::vector<std::uint32_t> index_in_slab;
  for (std::uint32_t n = 0; n < points.size(); ++n) index_in_slab.push_back(cell.index_in_slab[points[n]]);
  worker.unwritten.note_from([&] {
    sink.recalled({cell.slab, index_in_slab.data(), worker.chosen.rows(), worker.results.data(), points.size()});
  });
}

}  // namespace pointsweep
