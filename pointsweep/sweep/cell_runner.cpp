// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/cell_runner.h"

#include <algorithm>
#include <cmath>

#include "pointsweep/sweep/apply_step.h"
#include "pointsweep/sweep/shorten.h"
#include "pointsweep/sweep/stopwatch.h"

namespace pointsweep {

namespace {

/// The `share` quantile of the reach of a cell's points, from at most 128 of them.
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

/// One in eight may be left behind before a whole cell waits again.
constexpr std::size_t kStragglers = 8;

}  // namespace

CellRunner::CellRunner(const SweepPlan& plan, Window& window, const Outside& outside, Sink& sink,
                       const RunnerMemory& memory)
    : plan_(plan),
      window_(window),
      outside_(outside),
      sink_(sink),
      read_of_neighbors_(plan.column_bytes.size()),
      memory_(memory) {
  point_bytes_ += plan.lasting_bytes();
  for (const Stage& stage : plan.stages)
    for (const std::uint16_t column : stage.reads_neighbors) read_of_neighbors_[column] = true;
}

void CellRunner::run(std::uint32_t slot, std::uint32_t step, Worker& worker) const {
  WindowCell& cell = window_.at(slot);
  bool all_found = false;
  if (step == 0) {
    all_found = find_reaches(slot, worker);
    if (!certify(cell, worker)) return;
  }
  place_columns(plan_, step, cell, worker);
  step == 0 ? run_first_step(slot, all_found, worker) : run_later_step(slot, step, worker);
  cell.steps_done = step + 1;
  if (cell.steps_done == plan_.step_count()) finish(cell, worker);
}

/// How far each neighbourhood reaches. True if all lists were found on the way and are in worker.neighbors. Without a
/// limit k it is the radius, and no search is needed to know it.
bool CellRunner::find_reaches(std::uint32_t slot, Worker& worker) const {
  const std::uint32_t size = window_.at(slot).cell.size();
  worker.reach2.clear();
  if (plan_.neighborhood.k == Neighborhood::kUnlimited) {
    worker.reach2.assign(size, plan_.neighborhood.radius2());
    return false;
  }
  std::uint32_t end = 0;
  bool one_run = true;
  while (end < size) {
    one_run = end == 0;
    end = find_lists(slot, end, worker);
    worker.reach2.insert(worker.reach2.end(), worker.neighbors.reach2.begin(), worker.neighbors.reach2.end());
  }
  return one_run;
}

/// Lists of the points from `first` on, as many as the memory for them allows, not shortened. Returns their end.
std::uint32_t CellRunner::find_lists(std::uint32_t slot, std::uint32_t first, Worker& worker) const {
  const Stopwatch watch(worker.search_seconds);
  const std::uint64_t most = memory_.lists_bytes / sizeof(NeighborRef);
  return search_points(window_.directory(), slot, first, most, plan_.neighborhood, worker.search, worker.neighbors);
}

/// The points of a cell from `first` on, with what the file gave.
PointColumns CellRunner::own_from(const WindowCell& cell, std::uint32_t first, Worker& worker) const {
  worker.own_columns.clear();
  for (std::size_t c = 0; c < cell.column_pointers.size(); ++c) {
    const std::byte* const column = cell.column_pointers[c];
    worker.own_columns.push_back(column == nullptr ? nullptr : column + std::size_t{first} * plan_.column_bytes[c]);
  }
  const Cell& c = cell.cell;
  return {c.x + first, c.y + first, c.z + first, c.row + first, worker.own_columns.data()};
}

/// The lists of a cell are found run by run. Each run is used at once; later steps keep what fits.
void CellRunner::run_first_step(std::uint32_t slot, bool all_found, Worker& worker) const {
  WindowCell& cell = window_.at(slot);
  const bool later = plan_.step_count() > 1;
  bool kept = later;
  for (std::uint32_t first = 0, end = 0; first < cell.cell.size(); first = end) {
    end = all_found ? cell.cell.size() : find_lists(slot, first, worker);
    if (later) note_named(cell, first, worker.neighbors, worker);
    shorten(plan_, own_from(cell, first, worker), end - first, window_.slots(), worker.neighbors);
    kept = kept && keep_lists(cell, worker.neighbors);
    apply_step(plan_, 0, cell, first, worker.neighbors, window_.slots(), worker);
  }
  if (!later) return;
  refer_to_named(cell, worker);
  if (!kept) return release_lists(cell);
  if (!plan_.neighborhood.rule) return;
  std::uint32_t first = 0;
  for (const CellNeighbors& lists : cell.lists) {
    note_named(cell, first, lists, worker);
    first += lists.size();
  }
  refer_to_named(cell, worker);
}

/// With the lists that were kept, or the same ones found again: within their certified balls nothing has come, and what
/// they name has stayed.
void CellRunner::run_later_step(std::uint32_t slot, std::uint32_t step, Worker& worker) const {
  WindowCell& cell = window_.at(slot);
  std::uint32_t first = 0;
  const auto use = [&](const CellNeighbors& lists) {
    defer_points_of_deferred_neighbors(cell, first, lists);
    apply_step(plan_, step, cell, first, lists, window_.slots(), worker);
    first += lists.size();
  };
  for (const CellNeighbors& lists : cell.lists) use(lists);
  while (first < cell.cell.size()) {
    const std::uint32_t end = find_lists(slot, first, worker);
    shorten(plan_, own_from(cell, first, worker), end - first, window_.slots(), worker.neighbors);
    use(worker.neighbors);
  }
}

/// Notes which cells the lists name. Most neighbours are in one of two cells, so that sixteen at a time are known
/// already.
void CellRunner::note_named(const WindowCell& cell, std::uint32_t first, const CellNeighbors& lists,
                            Worker& worker) const {
  constexpr std::ptrdiff_t kTogether = 16;
  std::vector<std::uint32_t>& slots = worker.named;
  std::uint32_t last = ~0u, before = ~0u;
  const auto known = [&](const NeighborRef* refs) {
    std::uint32_t others = 0;
    for (std::ptrdiff_t j = 0; j < kTogether; ++j) others |= (slot_of(refs[j]) ^ last) & -(slot_of(refs[j]) != before);
    return others == 0;
  };
  const auto note = [&](NeighborRef ref) {
    const std::uint32_t slot = slot_of(ref);
    if (slot == last || slot == before) return;
    before = last, last = slot;
    if (slot >= worker.is_named.size()) worker.is_named.resize(slot + 1, false);
    if (!worker.is_named[slot]) slots.push_back(slot);
    worker.is_named[slot] = true;
  };
  const auto note_all = [&](std::uint32_t begin, std::uint32_t end) {
    const NeighborRef *ref = lists.refs.data() + begin, *const behind = lists.refs.data() + end;
    for (; behind - ref >= kTogether; ref += kTogether) {
      if (!known(ref)) std::for_each_n(ref, kTogether, note);
    }
    std::for_each(ref, behind, note);
  };
  if (cell.deferred.empty()) return note_all(lists.begin.front(), lists.begin.back());
  for (std::uint32_t i = 0; i < lists.size(); ++i)
    if (!cell.is_deferred(first + i)) note_all(lists.begin[i], lists.begin[i + 1]);
}

/// The cells noted since the last call stay in the window until this cell is finished.
void CellRunner::refer_to_named(WindowCell& cell, Worker& worker) {
  for (const std::uint32_t slot : worker.named) worker.is_named[slot] = false;
  std::sort(worker.named.begin(), worker.named.end());
  cell.refers_to.assign(worker.named.begin(), worker.named.end());
  worker.named.clear();
}

/// If there is room.
bool CellRunner::keep_lists(WindowCell& cell, const CellNeighbors& found) const {
  const std::uint64_t bytes = found.list_bytes();
  if (list_bytes_.fetch_add(bytes) + bytes + window_.points() * point_bytes_ > memory_.cells_bytes) {
    list_bytes_ -= bytes;
    return false;
  }
  cell.lists.emplace_back();
  cell.lists.back().begin = found.begin;
  cell.lists.back().refs = found.refs;
  return true;
}

void CellRunner::release_lists(WindowCell& cell) const {
  for (const CellNeighbors& lists : cell.lists) list_bytes_ -= lists.list_bytes();
  cell.lists = {};
}

/// Every ball must be clear of unread slabs and of dropped cells. False if the cell is to wait and be searched again.
bool CellRunner::certify(WindowCell& cell, Worker& worker) const {
  const std::vector<double>& reach2s = worker.reach2;
  const Box& box = cell.cell.box;
  const double most = *std::max_element(reach2s.begin(), reach2s.end());
  const bool ahead = outside_.unread_within(box, most);
  outside_.dropped_near(box, most, worker.dropped);
  std::vector<std::uint32_t> early, behind;
  for (std::uint32_t i = 0; (ahead || !worker.dropped.empty()) && i < cell.cell.size(); ++i) {
    const Vec3 p = cell.cell.position(i);
    const double reach2 = reach2s[i];
    if (ahead && outside_.unread_within(p, reach2)) {
      early.push_back(i);
    } else if (std::any_of(worker.dropped.begin(), worker.dropped.end(),
                           [&](const Box& b) { return distance2(b, p) <= reach2; })) {
      behind.push_back(i);
    }
  }
  if (early.size() * kStragglers > cell.cell.size()) {
    wait(cell, reach2s);
    return false;
  }
  for (const std::uint32_t i : early) defer(cell, i, reach2s[i]);
  for (const std::uint32_t i : behind) defer(cell, i, reach2s[i]);
  cell.certified = cell.cell.size() - early.size() - behind.size();
  cell.reach = std::min(reach_of_most(reach2s, 0.9), cell.cell.box.diagonal() + cell.wait_reach);
  return true;
}

/// The cell waits with a better idea of its reach than its density gave.
void CellRunner::wait(WindowCell& cell, const std::vector<double>& reach2) const {
  const double needed = reach_of_most(reach2, 1 - 1.0 / kStragglers);
  cell.wait_reach = std::max(cell.wait_reach, std::isfinite(needed) ? needed : 0);
  cell.wait_for_slabs = outside_.slabs_read() + 1;
  for (std::uint32_t i = 0; i < cell.cell.size(); ++i) {
    double& reach = cell.leaf_reach[i / kLeafCapacity];
    if (std::isfinite(reach2[i])) reach = std::max(reach, std::sqrt(reach2[i]));
  }
}

void CellRunner::defer(WindowCell& cell, std::uint32_t i, double reach2) {
  if (cell.deferred.empty()) cell.deferred.resize(cell.cell.size(), 0);
  cell.deferred[i] = 1;
  cell.left_to_recall.push_back(
      {cell.cell.position(i), cell.cell.row[i], cell.slab, cell.index_in_slab[i], reach2, cell.steps_done});
}

/// What a neighbour could not give in time, its dependants cannot use: they follow it into the recall.
void CellRunner::defer_points_of_deferred_neighbors(WindowCell& cell, std::uint32_t first,
                                                    const CellNeighbors& lists) const {
  const auto any = std::any_of(cell.refers_to.begin(), cell.refers_to.end(),
                               [&](std::uint32_t slot) { return !window_.at(slot).deferred_before.empty(); });
  if (!any) return;
  std::vector<std::uint32_t> follow;
  for (std::uint32_t i = 0; i < lists.size(); ++i) {
    if (cell.is_deferred(first + i)) continue;
    for (std::uint32_t j = lists.begin[i]; j < lists.begin[i + 1]; ++j) {
      const NeighborRef ref = lists.refs[j];
      if (window_.at(slot_of(ref)).was_deferred(index_of(ref))) {
        follow.push_back(first + i);
        break;
      }
    }
  }
  cell.certified -= follow.size();
  for (const std::uint32_t i : follow) defer(cell, i, Box::kInf);
}

void CellRunner::finish(WindowCell& cell, Worker& worker) const {
  if (!cell.was_finished) hand_over(cell, worker);
  cell.left_to_recall = {};
  release_lists(cell);
  cell.refers_to = {};
  if (plan_.step_count() == 1) drop_columns(cell);
}

void CellRunner::hand_over(const WindowCell& cell, Worker& worker) const {
  worker.certified += cell.certified;
  for (std::size_t s = 0; s < cell.degenerate.size(); ++s)
    cell.degenerate[s].for_each([&](std::size_t i) { worker.tally.degenerate[s].add(cell.cell.row[i]); });
  worker.deferred.insert(worker.deferred.end(), cell.left_to_recall.begin(), cell.left_to_recall.end());
  for (const DeferredPoint& point : cell.left_to_recall) sink_.deferred(point.slab, point.index_in_slab);
  collect_results(plan_, worker.columns.data(), cell.cell.size(), worker.results);
  // Runs between deferred points, which are somebody else's to finish.
  for (std::uint32_t i = 0; i < cell.cell.size();) {
    std::uint32_t end = i;
    while (end < cell.cell.size() && !cell.is_deferred(end)) ++end;
    if (end > i) {
      sink_.finished({cell.slab, cell.index_in_slab.data() + i, cell.cell.row + i,
                      worker.results.data() + std::size_t{i} * plan_.result_bytes, end - i});
    }
    i = end + 1;
  }
}

/// After the only step others may still read some of what the file gave.
void CellRunner::drop_columns(WindowCell& cell) const {
  for (std::size_t c = 0; c < cell.columns.size(); ++c) {
    if (read_of_neighbors_[c]) continue;
    cell.columns[c] = {};
    cell.column_pointers[c] = nullptr;
  }
}

}  // namespace pointsweep
