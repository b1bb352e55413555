// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/cell_runner.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

#include "pointsweep/sweep/shorten.h"

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
                       std::uint64_t cells_bytes)
    : plan_(plan),
      window_(window),
      outside_(outside),
      sink_(sink),
      read_of_neighbors_(plan.column_bytes.size()),
      cells_bytes_(cells_bytes) {
  point_bytes_ += plan.lasting_bytes();
  for (const Stage& stage : plan.stages)
    for (const std::uint16_t column : stage.reads_neighbors) read_of_neighbors_[column] = true;
}

void CellRunner::run(std::uint32_t slot, std::uint32_t step, Worker& worker) const {
  WindowCell& cell = window_.at(slot);
  if (step == 0 && !search(slot, worker)) return;
  const CellNeighbors& lists = step == 0 ? worker.neighbors : lists_of(slot, worker);
  if (step > 0) defer_points_of_deferred_neighbors(cell, lists);
  const std::uint64_t degenerate_before = worker.tally.degenerate;
  apply(cell, step, lists, worker);
  cell.degenerate += worker.tally.degenerate - degenerate_before;
  cell.steps_done = step + 1;
  if (cell.steps_done == plan_.step_count()) finish(cell, worker);
}

bool CellRunner::search(std::uint32_t slot, Worker& worker) const {
  const auto start = std::chrono::steady_clock::now();
  WindowCell& cell = window_.at(slot);
  search_cell(window_.directory(), slot, plan_.neighborhood, worker.search, worker.neighbors);
  const bool complete = certify(cell, worker.neighbors, worker);
  if (complete) {
    cell.reach = std::min(reach_of_most(worker.neighbors.reach2, 0.9), cell.cell.box.diagonal() + cell.wait_reach);
    const bool later = plan_.step_count() > 1;
    if (later) refer(cell, worker.neighbors, worker);
    shorten(plan_, cell.view(), cell.cell.size(), window_.slots(), worker.neighbors);
    if (later && keep_lists(cell, worker.neighbors) && plan_.neighborhood.rule) refer(cell, cell.lists, worker);
  }
  worker.search_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return complete;
}

/// Those kept, or the same ones found again: within their certified balls nothing has come, and what they name has
/// stayed.
const CellNeighbors& CellRunner::lists_of(std::uint32_t slot, Worker& worker) const {
  const WindowCell& cell = window_.at(slot);
  if (!cell.lists.begin.empty()) return cell.lists;
  const auto start = std::chrono::steady_clock::now();
  search_cell(window_.directory(), slot, plan_.neighborhood, worker.search, worker.neighbors);
  shorten(plan_, cell.view(), cell.cell.size(), window_.slots(), worker.neighbors);
  worker.search_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return worker.neighbors;
}

/// Notes which cells the lists name: these stay. Most neighbours are in one of two cells, so that sixteen at a time are
/// known already.
void CellRunner::refer(WindowCell& cell, const CellNeighbors& lists, Worker& worker) const {
  constexpr std::ptrdiff_t kTogether = 16;
  std::vector<std::uint32_t>& slots = worker.named;
  slots.clear();
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
  const auto note_all = [&](std::uint32_t first, std::uint32_t behind) {
    const NeighborRef *ref = lists.refs.data() + first, *const end = lists.refs.data() + behind;
    for (; end - ref >= kTogether; ref += kTogether) {
      if (!known(ref)) std::for_each_n(ref, kTogether, note);
    }
    std::for_each(ref, end, note);
  };
  if (cell.deferred.empty()) {
    note_all(lists.begin.front(), lists.begin.back());
  } else {
    for (std::uint32_t i = 0; i < cell.cell.size(); ++i)
      if (!cell.is_deferred(i)) note_all(lists.begin[i], lists.begin[i + 1]);
  }
  for (const std::uint32_t slot : slots) worker.is_named[slot] = false;
  std::sort(slots.begin(), slots.end());
  cell.refers_to.assign(slots.begin(), slots.end());
}

/// If there is room.
bool CellRunner::keep_lists(WindowCell& cell, const CellNeighbors& found) const {
  const std::uint64_t bytes = found.refs.size() * sizeof(NeighborRef) + found.begin.size() * sizeof(std::uint32_t);
  if (list_bytes_.fetch_add(bytes) + bytes + window_.points() * point_bytes_ > cells_bytes_) {
    list_bytes_ -= bytes;
    return false;
  }
  cell.lists.begin = found.begin;
  cell.lists.refs = found.refs;
  return true;
}

void CellRunner::release_lists(WindowCell& cell) const {
  list_bytes_ -= cell.lists.refs.size() * sizeof(NeighborRef) + cell.lists.begin.size() * sizeof(std::uint32_t);
  cell.lists = {};
}

/// Every ball must be clear of unread slabs and of dropped cells. False if the cell is to wait and be searched again.
bool CellRunner::certify(WindowCell& cell, const CellNeighbors& found, Worker& worker) const {
  const Box& box = cell.cell.box;
  const double most = *std::max_element(found.reach2.begin(), found.reach2.end());
  const bool ahead = outside_.unread_within(box, most);
  outside_.dropped_near(box, most, worker.dropped);
  std::vector<std::uint32_t> early, behind;
  for (std::uint32_t i = 0; (ahead || !worker.dropped.empty()) && i < cell.cell.size(); ++i) {
    const Vec3 p = cell.cell.position(i);
    const double reach2 = found.reach2[i];
    if (ahead && outside_.unread_within(p, reach2)) {
      early.push_back(i);
    } else if (std::any_of(worker.dropped.begin(), worker.dropped.end(),
                           [&](const Box& b) { return distance2(b, p) <= reach2; })) {
      behind.push_back(i);
    }
  }
  if (early.size() * kStragglers > cell.cell.size()) {
    wait(cell, found);
    return false;
  }
  for (const std::uint32_t i : early) defer(cell, i, found.reach2[i]);
  for (const std::uint32_t i : behind) defer(cell, i, found.reach2[i]);
  cell.certified = cell.cell.size() - early.size() - behind.size();
  return true;
}

/// The cell waits with a better idea of its reach than its density gave.
void CellRunner::wait(WindowCell& cell, const CellNeighbors& found) const {
  const double needed = reach_of_most(found.reach2, 1 - 1.0 / kStragglers);
  cell.wait_reach = std::max(cell.wait_reach, std::isfinite(needed) ? needed : 0);
  cell.wait_for_slabs = outside_.slabs_read() + 1;
  for (std::uint32_t i = 0; i < cell.cell.size(); ++i) {
    double& reach = cell.leaf_reach[i / kLeafCapacity];
    if (std::isfinite(found.reach2[i])) reach = std::max(reach, std::sqrt(found.reach2[i]));
  }
}

void CellRunner::defer(WindowCell& cell, std::uint32_t i, double reach2) {
  if (cell.deferred.empty()) cell.deferred.resize(cell.cell.size(), 0);
  cell.deferred[i] = 1;
  cell.left_to_recall.push_back(
      {cell.cell.position(i), cell.cell.row[i], cell.slab, cell.index_in_slab[i], reach2, cell.steps_done});
}

/// What a neighbour could not give in time, its dependants cannot use: they follow it into the recall.
void CellRunner::defer_points_of_deferred_neighbors(WindowCell& cell, const CellNeighbors& lists) const {
  const auto any = std::any_of(cell.refers_to.begin(), cell.refers_to.end(),
                               [&](std::uint32_t slot) { return !window_.at(slot).deferred_before.empty(); });
  if (!any) return;
  std::vector<std::uint32_t> follow;
  for (std::uint32_t i = 0; i < cell.cell.size(); ++i) {
    if (cell.is_deferred(i)) continue;
    for (std::uint32_t j = lists.begin[i]; j < lists.begin[i + 1]; ++j) {
      const NeighborRef ref = lists.refs[j];
      if (window_.at(slot_of(ref)).was_deferred(index_of(ref))) {
        follow.push_back(i);
        break;
      }
    }
  }
  cell.certified -= follow.size();
  for (const std::uint32_t i : follow) defer(cell, i, Box::kInf);
}

/// Columns that outlast the step are the cell's own. All are 0 where an operator says nothing.
void CellRunner::place_columns(WindowCell& cell, std::uint32_t step, Worker& worker) const {
  constexpr std::size_t kLine = 64;
  std::size_t passing = 0;
  const auto of_step = [&](auto use) {
    for (std::size_t s = plan_.steps[step]; s < plan_.steps[step + 1]; ++s) {
      for (const std::uint16_t c : plan_.stages[s].makes)
        use(c, (plan_.column_bytes[c] * cell.cell.size() + kLine - 1) / kLine * kLine);
    }
  };
  of_step([&](std::uint16_t c, std::size_t bytes) {
    if (plan_.lasting[c] == Lasting::its_cell) {
      cell.make_column(c, plan_.column_bytes[c]);
    } else {
      passing += bytes;
    }
  });
  worker.passing.assign(passing, std::byte{0});
  worker.columns.clear();
  for (auto& column : cell.columns) worker.columns.push_back(column.data());
  std::byte* at = worker.passing.data();
  of_step([&](std::uint16_t c, std::size_t bytes) {
    if (plan_.lasting[c] != Lasting::its_cell) worker.columns[c] = at, at += bytes;
  });
}

void CellRunner::apply(WindowCell& cell, std::uint32_t step, const CellNeighbors& lists, Worker& worker) const {
  place_columns(cell, step, worker);
  if (!cell.deferred.empty()) return apply_to_some(cell, step, lists, worker);
  const Cell& c = cell.cell;
  const Batch batch{{c.x, c.y, c.z, c.row, worker.columns.data()},
                    c.size(),
                    window_.slots(),
                    lists.begin.data(),
                    lists.refs.data(),
                    worker.columns.data()};
  run_step(plan_, step, batch, worker.tally);
}

/// The same for a cell some of whose points are deferred: on a copy that holds only the others.
void CellRunner::apply_to_some(WindowCell& cell, std::uint32_t step, const CellNeighbors& lists, Worker& worker) const {
  std::vector<std::uint32_t> chosen;
  for (std::uint32_t i = 0; i < cell.cell.size(); ++i) {
    if (!cell.is_deferred(i)) chosen.push_back(i);
  }
  std::vector<double> x, y, z;
  std::vector<std::uint64_t> row;
  CellNeighbors some;
  some.begin.push_back(0);
  for (const std::uint32_t i : chosen) {
    x.push_back(cell.cell.x[i]), y.push_back(cell.cell.y[i]), z.push_back(cell.cell.z[i]),
        row.push_back(cell.cell.row[i]);
    some.refs.insert(some.refs.end(), lists.refs.begin() + lists.begin[i], lists.refs.begin() + lists.begin[i + 1]);
    some.begin.push_back(static_cast<std::uint32_t>(some.refs.size()));
  }
  std::vector<std::vector<std::byte>> columns(worker.columns.size());
  std::vector<std::byte*> pointers;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (worker.columns[c] != nullptr) {
      const std::size_t bytes = plan_.column_bytes[c];
      columns[c].resize(chosen.size() * bytes);
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        std::memcpy(columns[c].data() + i * bytes, worker.columns[c] + chosen[i] * bytes, bytes);
      }
    }
    pointers.push_back(columns[c].data());
  }
  const Batch batch{{x.data(), y.data(), z.data(), row.data(), pointers.data()},
                    chosen.size(),
                    window_.slots(),
                    some.begin.data(),
                    some.refs.data(),
                    pointers.data()};
  run_step(plan_, step, batch, worker.tally);
  for (std::size_t s = plan_.steps[step]; s < plan_.steps[step + 1]; ++s) {
    for (const std::uint16_t c : plan_.stages[s].makes) {
      const std::size_t bytes = plan_.column_bytes[c];
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        std::memcpy(worker.columns[c] + chosen[i] * bytes, columns[c].data() + i * bytes, bytes);
      }
    }
  }
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
  worker.degenerate += cell.degenerate;
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
