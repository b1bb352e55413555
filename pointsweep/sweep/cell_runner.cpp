// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/cell_runner.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pointsweep/free_memory.h"
#include "pointsweep/sweep/worker.h"

namespace pointsweep {
namespace {

/// Returns the `share` quantile of the reaches of a cell's points, from at most 128 of the points.
double reach_of_most(const std::vector<double>& reach2, double share) {
  constexpr std::size_t kMost = 128;
  std::vector<double> sample;
  sample.reserve(kMost);
  const std::size_t step = (reach2.size() + kMost - 1) / kMost;
  for (std::size_t i = 0; i < reach2.size(); i += step) sample.push_back(reach2[i]);
  const auto at = sample.begin() + static_cast<std::ptrdiff_t>(static_cast<double>(sample.size() - 1) * share);
  std::nth_element(sample.begin(), at, sample.end());
  return std::sqrt(*at);
}

/// The quantile of the reaches of a cell's points that counts as the reach of the cell, which decides how long the cell
/// stays in the window.
constexpr double kCountedShare = 0.9;

/// Points whose reach is at most this many times the counted reach of their cell are worth a wait. Points that reach
/// farther, such as outliers, are deferred, since their cell would stay in the window for long.
constexpr double kWorthWaiting = 5;

/// Returns the greatest reach of the points in `early` that are worth a wait (kWorthWaiting); 0 if no point is.
double reach_worth_waiting(const std::vector<double>& reach2, const std::vector<std::uint32_t>& early) {
  double worth = 0;
  if (early.empty()) return worth;
  const double most = kWorthWaiting * reach_of_most(reach2, kCountedShare);
  for (const std::uint32_t i : early) {
    const double reach = std::sqrt(reach2[i]);
    if (std::isfinite(reach) && reach <= most) worth = std::max(worth, reach);
  }
  return worth;
}

/// Makes the cell wait for unread slabs. Raises its leaf_reach to the finite reaches that the search has found, and its
/// wait_reach to the reach of most of its points and to `least`.
void wait(WindowCell& cell, const std::vector<double>& reach2, double least, const Frontier& frontier) {
  const double needed = reach_of_most(reach2, 1 - 1.0 / kStragglers);
  cell.wait_reach = std::max({cell.wait_reach, least, std::isfinite(needed) ? needed : 0});
  cell.wait_for_slabs = frontier.slabs_read() + 1;
  for (std::uint32_t i = 0; i < cell.cell.size(); ++i) {
    double& reach = cell.leaf_reach[i / kLeafCapacity];
    if (std::isfinite(reach2[i])) reach = std::max(reach, std::sqrt(reach2[i]));
  }
}

void leave_out(WindowCell& cell, std::uint32_t i) {
  if (cell.deferred.empty()) cell.deferred.resize(cell.cell.size(), 0);
  cell.deferred[i] = 1;
}

void defer(WindowCell& cell, std::uint32_t i, double reach2) {
  leave_out(cell, i);
  cell.left_to_recall.push_back(
      {cell.cell.position(i), cell.cell.row[i], cell.slab, cell.index_in_slab[i], reach2, cell.steps_done});
}

/// Returns the squared distance at which the neighbourhood of list `i`, of a point at `p`, ends; infinite if a rule may
/// have shortened the list, or if the list has fewer than k neighbours.
double end_of_list(const Neighborhood& what, Vec3 p, const CellNeighbors& lists, std::uint32_t i,
                   const Window& window) {
  if (what.rule || lists.begin[i + 1] - lists.begin[i] < what.k) return Box::kInf;
  const NeighborRef last = lists.refs[lists.begin[i + 1] - 1];
  return distance2(p, window.at(slot_of(last)).cell.position(index_of(last)));
}

/// Certifies the points of a cell. The ball of a point has the squared radius worker.reach2 and must touch no unread
/// slab and no dropped cell; otherwise the point is deferred. Returns false if many balls, or any ball that is
/// worth a wait, touch slabs that the sweep has still to read: the cell then waits and is searched again. A cell does
/// not wait for slabs that only the recall reads.
bool certify(WindowCell& cell, const Frontier& frontier, Worker& worker) {
  const std::vector<double>& reach2s = worker.reach2;
  const Box& box = cell.cell.box;
  const double most = *std::max_element(reach2s.begin(), reach2s.end());
  const bool ahead = frontier.still_read_within(box, most), beyond = frontier.only_recalled_within(box, most);
  frontier.dropped_near(box, most, worker.dropped);
  std::vector<std::uint32_t> early, out_of_reach;
  for (std::uint32_t i = 0; (ahead || beyond || !worker.dropped.empty()) && i < cell.cell.size(); ++i) {
    const Vec3 p = cell.cell.position(i);
    const double reach2 = reach2s[i];
    if (ahead && frontier.still_read_within(p, reach2)) {
      early.push_back(i);
    } else if ((beyond && frontier.only_recalled_within(p, reach2)) ||
               std::any_of(worker.dropped.begin(), worker.dropped.end(),
                           [&](const Box& b) { return distance2(b, p) <= reach2; })) {
      out_of_reach.push_back(i);
    }
  }
  const double worth = reach_worth_waiting(reach2s, early);
  if (worth > 0 || early.size() * kStragglers > cell.cell.size()) {
    wait(cell, reach2s, worth, frontier);
    return false;
  }
  for (const std::uint32_t i : early) defer(cell, i, reach2s[i]);
  for (const std::uint32_t i : out_of_reach) defer(cell, i, reach2s[i]);
  cell.certified = cell.cell.size() - early.size() - out_of_reach.size();
  cell.reach = std::min(reach_of_most(reach2s, kCountedShare), cell.cell.box.diagonal() + cell.wait_reach);
  return true;
}

/// Defers the points of the cell, from `first` on, whose lists contain a point that was deferred before this step,
/// since its values are missing.
void defer_dependents(const Neighborhood& what, WindowCell& cell, std::uint32_t first, const CellNeighbors& lists,
                      const Window& window) {
  const auto any = std::any_of(cell.refers_to.begin(), cell.refers_to.end(),
                               [&](std::uint32_t slot) { return !window.at(slot).deferred_before.empty(); });
  if (!any) return;
  std::vector<std::pair<std::uint32_t, double>> follow;  // points to defer, with their squared reach
  for (std::uint32_t i = 0; i < lists.size(); ++i) {
    if (cell.is_deferred(first + i)) continue;
    for (std::uint32_t j = lists.begin[i]; j < lists.begin[i + 1]; ++j) {
      const NeighborRef ref = lists.refs[j];
      if (window.at(slot_of(ref)).was_deferred(index_of(ref))) {
        follow.emplace_back(first + i, end_of_list(what, cell.cell.position(first + i), lists, i, window));
        break;
      }
    }
  }
  cell.certified -= follow.size();
  for (const auto& [i, reach2] : follow) defer(cell, i, reach2);
}

}  // namespace

CellRunner::CellRunner(const SweepPlan& plan, Window& window, const Frontier& frontier, Sink& sink,
                       const ListMemory& memory)
    : plan_(plan),
      window_(window),
      frontier_(frontier),
      sink_(sink),
      read_of_neighbors_(plan.column_bytes.size()),
      lists_(plan, window, memory) {
  for (const Stage& stage : plan.stages)
    for (const std::uint16_t column : stage.reads_neighbors) read_of_neighbors_[column] = true;
}

void CellRunner::run(std::uint32_t slot, std::uint32_t step, Worker& worker) const {
  WindowCell& cell = window_.at(slot);
  if (cell.is_only_looked_at && step + 1 == plan_.step_count()) return look_no_further(cell, step);
  bool all_found = false;
  if (step == 0) {
    all_found = lists_.find_reaches(slot, worker);
    if (!certify(cell, frontier_, worker)) return;
  }
  place_columns(plan_, step, cell, worker);
  step == 0 ? run_first_step(slot, all_found, worker) : run_later_step(slot, step, worker);
  cell.steps_done = step + 1;
  if (cell.steps_done == plan_.step_count()) finish(cell, worker);
}

/// Skips the last step of a cell whose results are not delivered: no other cell reads results of the last step.
void CellRunner::look_no_further(WindowCell& cell, std::uint32_t step) const {
  if (step == 0) cell.reach = cell.wait_reach;
  cell.steps_done = step + 1;
  free_memory_of(cell.left_to_recall);
  lists_.release(cell);
  free_memory_of(cell.refers_to);
}

/// Takes the first step. The lists of a cell are found and used for one run of points after another; lists for later
/// steps are stored if the lists of all runs fit in memory.
void CellRunner::run_first_step(std::uint32_t slot, bool all_found, Worker& worker) const {
  WindowCell& cell = window_.at(slot);
  const bool later = plan_.step_count() > 1;
  bool kept = later;
  for (std::uint32_t first = 0, size = cell.cell.size(); first < size;) {
    const CellSubset rest(first, size);
    const CellSubset run = rest.part(0, all_found ? size : lists_.find(slot, rest, worker));
    if (later) CellLists::note_references(cell, first, worker.neighbors, worker);
    lists_.truncate(cell, run, worker);
    kept = kept && lists_.keep(cell, worker.neighbors);
    apply(0, cell, run, worker.neighbors, worker);
    first += run.size();
  }
  if (!later) return;
  CellLists::hold_references(cell, worker);
  if (!kept) return lists_.release(cell);
  if (!plan_.neighborhood.rule) return;
  std::uint32_t first = 0;
  for (const CellNeighbors& lists : cell.lists) {
    CellLists::note_references(cell, first, lists, worker);
    first += lists.size();
  }
  CellLists::hold_references(cell, worker);
}

/// Takes a later step with the stored lists, or searches again, which finds equal lists: no point has entered the
/// certified balls, and the cells of the lists are still in the window.
void CellRunner::run_later_step(std::uint32_t slot, std::uint32_t step, Worker& worker) const {
  WindowCell& cell = window_.at(slot);
  const std::uint32_t size = cell.cell.size();
  std::uint32_t first = 0;
  const auto use = [&](const CellNeighbors& lists) {
    defer_dependents(plan_.neighborhood, cell, first, lists, window_);
    apply(step, cell, {first, first + lists.size()}, lists, worker);
    first += lists.size();
  };
  for (const CellNeighbors& lists : cell.lists) use(lists);
  while (first < size) {
    const CellSubset rest(first, size);
    lists_.truncate(cell, rest.part(0, lists_.find(slot, rest, worker)), worker);
    use(worker.neighbors);
  }
}

/// Applies the step to the points of the run that are not deferred, and marks degenerate points in the cell.
void CellRunner::apply(std::uint32_t step, WindowCell& cell, const CellSubset& run, const CellNeighbors& lists,
                       Worker& worker) const {
  StageTally& tally = cell.is_only_looked_at ? worker.halo : worker.tally;
  const auto mark = [&](const CellSubset& part) {
    for_each_marked(plan_, step, tally, [&](std::size_t stage, std::size_t n) {
      if (cell.degenerate.empty()) cell.degenerate.resize(plan_.stages.size());
      cell.degenerate[stage].mark(part[static_cast<std::uint32_t>(n)]);
    });
  };
  if (cell.deferred.empty())
    return apply_step(plan_, step, cell.cell, run, lists, window_.slots(), worker, tally, mark);
  std::vector<std::uint32_t> chosen, numbers;
  for (std::uint32_t n = 0; n < run.size(); ++n) {
    if (cell.is_deferred(run[n])) continue;
    chosen.push_back(run[n]);
    numbers.push_back(n);
  }
  worker.chosen_lists = lists;
  keep_lists_of(numbers, worker.chosen_lists);
  apply_step(plan_, step, cell.cell, chosen, worker.chosen_lists, window_.slots(), worker, tally, mark);
}

void CellRunner::finish(WindowCell& cell, Worker& worker) const {
  hand_over(cell, worker);
  free_memory_of(cell.left_to_recall);
  lists_.release(cell);
  free_memory_of(cell.refers_to);
  if (plan_.step_count() == 1) drop_columns(cell);
}

void CellRunner::hand_over(const WindowCell& cell, Worker& worker) const {
  worker.certified += cell.certified;
  worker.tally.degenerate.resize(plan_.stages.size());
  for (std::size_t s = 0; s < cell.degenerate.size(); ++s)
    cell.degenerate[s].for_each([&](std::size_t i) { worker.tally.degenerate[s].add(cell.cell.row[i]); });
  worker.deferred.insert(worker.deferred.end(), cell.left_to_recall.begin(), cell.left_to_recall.end());
  for (std::uint32_t i = 0; i < cell.deferred.size(); ++i)
    if (cell.is_deferred(i)) sink_.deferred(cell.slab, cell.index_in_slab[i]);
  collect_results(plan_, worker.columns.data(), cell.cell.size(), worker.results);
  // Delivers the points between deferred points. The recall finishes the deferred points.
  for (std::uint32_t i = 0; i < cell.cell.size();) {
    std::uint32_t end = i;
    while (end < cell.cell.size() && !cell.is_deferred(end)) ++end;
    if (end > i) {
      worker.unwritten.note_from([&] {
        sink_.finished({cell.slab, cell.index_in_slab.data() + i, cell.cell.row + i,
                        worker.results.data() + std::size_t{i} * plan_.result_bytes, end - i});
      });
    }
    i = end + 1;
  }
}

/// Drops the columns of a finished cell, except columns that stages may still read for points of other cells.
void CellRunner::drop_columns(WindowCell& cell) const {
  for (std::size_t c = 0; c < cell.columns.size(); ++c) {
    if (read_of_neighbors_[c]) continue;
    free_memory_of(cell.columns[c]);
    cell.column_pointers[c] = nullptr;
  }
}

}  // namespace pointsweep
