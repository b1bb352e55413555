// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/cell_lists.h"

#include <algorithm>

#include "pointsweep/free_memory.h"

namespace pointsweep {

bool CellLists::find_reaches(std::uint32_t slot, Worker& worker) const {
  const std::uint32_t size = cells_.at(slot).cell.size();
  worker.reach2.clear();
  if (plan_.neighborhood.k == Neighborhood::kUnlimited) {
    worker.reach2.assign(size, plan_.neighborhood.radius2());
    return false;
  }
  std::uint32_t end = 0;
  bool one_run = true;
  while (end < size) {
    one_run = end == 0;
    end += find(slot, {end, size}, worker);
    worker.reach2.insert(worker.reach2.end(), worker.neighbors.reach2.begin(), worker.neighbors.reach2.end());
  }
  return one_run;
}

std::uint32_t CellLists::find(std::uint32_t slot, const CellSubset& points, Worker& worker) const {
  const Stopwatch watch(worker.search_seconds);
  const std::uint64_t most = memory_.lists_bytes / sizeof(NeighborRef);
  return search({cells_.directory(), slot, plan_.neighborhood}, points, most, worker.search, worker.neighbors);
}

/// Returns `points` with all columns that the cell holds. Points that are not a run (CellSubset::is_run()) are copied
/// to worker.chosen.
PointColumns CellLists::own(const WindowCell& cell, const CellSubset& points, Worker& worker) const {
  if (!points.is_run()) {
    worker.chosen.take(plan_, cell.cell, points, cell.column_pointers.data());
    return worker.chosen.view();
  }
  const std::uint32_t first = points[0];
  worker.own_columns.clear();
  for (std::size_t c = 0; c < cell.column_pointers.size(); ++c) {
    const std::byte* const column = cell.column_pointers[c];
    worker.own_columns.push_back(column == nullptr ? nullptr : column + std::size_t{first} * plan_.column_bytes[c]);
  }
  const Cell& c = cell.cell;
  return {c.x + first, c.y + first, c.z + first, c.row + first, worker.own_columns.data()};
}

void CellLists::truncate(const WindowCell& cell, const CellSubset& points, Worker& worker) const {
  if (!plan_.neighborhood.rule) return;
  CellNeighbors& lists = worker.neighbors;
  std::vector<std::uint32_t> counts(points.size());
  plan_.neighborhood.rule->choose(Neighborhoods(own(cell, points, worker), points.size(), cells_.slots(),
                                                lists.begin.data(), lists.refs.data(), plan_.rule_reads, {}),
                                  counts);
  std::uint32_t end = 0;
  for (std::uint32_t n = 0; n < points.size(); ++n) {
    const std::uint32_t from = lists.begin[n], kept = std::min(counts[n], lists.begin[n + 1] - from);
    const auto first = lists.refs.begin() + from;
    std::copy(first, first + kept, lists.refs.begin() + end);
    lists.begin[n] = end;
    end += kept;
  }
  lists.begin[points.size()] = end;
  lists.refs.resize(end);
}

/// Most neighbours are in one of the two cells that were noted last, so sixteen neighbours at a time are compared with
/// these two, and noted one by one only if one of them is in another cell.
void CellLists::note_references(const WindowCell& cell, std::uint32_t first, const CellNeighbors& lists,
                                Worker& worker) {
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

void CellLists::hold_references(WindowCell& cell, Worker& worker) {
  for (const std::uint32_t slot : worker.named) worker.is_named[slot] = false;
  std::sort(worker.named.begin(), worker.named.end());
  cell.refers_to.assign(worker.named.begin(), worker.named.end());
  worker.named.clear();
}

bool CellLists::keep(WindowCell& cell, const CellNeighbors& found) const {
  const std::uint64_t bytes = found.list_bytes();
  if (bytes_.fetch_add(bytes) + bytes + cells_.points() * point_bytes_ > memory_.cells_bytes) {
    bytes_ -= bytes;
    return false;
  }
  cell.lists.emplace_back();
  cell.lists.back().begin = found.begin;
  cell.lists.back().refs = found.refs;
  return true;
}

void CellLists::release(WindowCell& cell) const {
  for (const CellNeighbors& lists : cell.lists) bytes_ -= lists.list_bytes();
  free_memory_of(cell.lists);
}

}  // namespace pointsweep
