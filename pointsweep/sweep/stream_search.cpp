// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/stream_search.h"

#include <algorithm>
#include <unordered_map>

#include "pointsweep/cancellation.h"
#include "pointsweep/search/exact_search.h"
#include "pointsweep/threads.h"

namespace pointsweep {

namespace {

/// One slab in memory with its cells, and what its queries take from it.
class SlabVisit {
 public:
  SlabVisit(const SweepPlan& plan, LoadedSlab slab) : plan_(plan), slab_(std::move(slab)) {
    for (std::uint32_t c = 0; c < slab_.cells.size(); ++c) directory_.add(c, &slab_.cells[c]->cell);
  }

  /// Merges the points of this slab into the query's neighbourhood.
  void serve(StreamQuery& query, std::uint32_t slab) const {
    BestList best;
    best.start(plan_.neighborhood, query.reach2);
    for (std::size_t i = 0; i < query.neighbors.size(); ++i) {
      query.neighbors[i].ref = kKept + static_cast<NeighborRef>(i);
      best.offer(query.neighbors[i]);
    }
    std::vector<CellDirectory::Near> near;
    directory_.find({query.position, query.position}, best.limit(), near);
    search_exact(directory_, near, query.position, query.row, best);
    take_columns(query, best.finish());
    query.neighbors = best.finish();
    if (query.neighbors.size() == plan_.neighborhood.k && !query.neighbors.empty()) {
      query.reach2 = std::min(query.reach2, query.neighbors.back().distance2);
    }
    find_self(query, slab, near);
  }

 private:
  /// Refs from here on mean: the neighbour of that number that the query had before.
  static constexpr NeighborRef kKept = 1u << 31;

  std::string columns_of(const WindowCell& cell, std::uint32_t i) const {
    std::string bytes;
    for (const FileColumn& file : plan_.file_columns) {
      const std::size_t n = plan_.column_bytes[file.column];
      bytes.append(reinterpret_cast<const char*>(cell.columns[file.column].data()) + i * n, n);
    }
    return bytes;
  }

  void take_columns(StreamQuery& query, const std::vector<Candidate>& found) const {
    if (plan_.file_columns.empty()) return;
    std::vector<std::string> columns;
    for (const Candidate& c : found) {
      columns.push_back(c.ref >= kKept ? query.neighbor_columns[c.ref - kKept]
                                       : columns_of(*slab_.cells[slot_of(c.ref)], index_of(c.ref)));
    }
    query.neighbor_columns = std::move(columns);
  }

  /// The query itself, if it lives here: its file columns and its place.
  void find_self(StreamQuery& query, std::uint32_t slab, const std::vector<CellDirectory::Near>& near) const {
    for (const auto& n : near) {
      const WindowCell& cell = *slab_.cells[n.slot];
      if (distance2(cell.cell.box, query.position) > 0) continue;
      for (std::uint32_t i = 0; i < cell.cell.size(); ++i) {
        if (cell.cell.row[i] != query.row) continue;
        query.file_columns = columns_of(cell, i);
        query.slab = slab;
        query.index_in_slab = cell.index_in_slab[i];
        return;
      }
    }
  }

  const SweepPlan& plan_;
  LoadedSlab slab_;
  CellDirectory directory_;
};

}  // namespace

std::uint64_t search_stream(const Stream& stream, const SweepPlan& plan, const SlabLoader& loader,
                            std::vector<StreamQuery>& queries) {
  std::uint64_t slabs_read = 0;
  const std::vector<Slab>& slabs = stream.slabs();
  const auto visit = [&](std::uint32_t slab, const std::vector<std::uint32_t>& chosen) {
    if (chosen.empty()) return;
    ++slabs_read;
    const SlabVisit here(plan, loader.load(slab, false));
    parallel_for(chosen.size(), [&](std::size_t i, unsigned) { here.serve(queries[chosen[i]], slab); });
  };
  const auto holds = [&](std::uint32_t slab, const StreamQuery& q) {
    return distance2(slabs[slab].box, q.position) == 0;
  };
  // First what lies in a query's own slab, so that every ball becomes finite; then what the balls touch.
  std::vector<std::vector<std::uint32_t>> seen(queries.size());  ///< boxes of slabs may overlap
  std::vector<std::uint32_t> chosen;
  for (std::uint32_t s = 0; s < slabs.size(); ++s) {
    stop_if_cancelled();
    chosen.clear();
    for (std::uint32_t q = 0; q < queries.size(); ++q) {
      if (queries[q].reach2 == Box::kInf && holds(s, queries[q])) chosen.push_back(q);
    }
    for (const std::uint32_t q : chosen) seen[q].push_back(s);
    visit(s, chosen);
  }
  for (std::uint32_t s = 0; s < slabs.size(); ++s) {
    stop_if_cancelled();
    chosen.clear();
    for (std::uint32_t q = 0; q < queries.size(); ++q) {
      if (!std::ranges::binary_search(seen[q], s) && distance2(slabs[s].box, queries[q].position) <= queries[q].reach2)
        chosen.push_back(q);
    }
    visit(s, chosen);
  }
  return slabs_read;
}

}  // namespace pointsweep
