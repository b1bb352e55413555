// SPDX-License-Identifier: MIT
#include "pointsweep/search/copies.h"

#include "pointsweep/search/plain_search.h"

namespace pointsweep {

std::uint32_t end_of_copies(const Cell& cell, std::uint32_t leaf) {
  if (cell.leaf_size(leaf) == 1) return leaf;
  const Vec3 place = cell.position(leaf * kLeafCapacity);
  const auto is_there = [&](std::uint32_t l) {
    return cell.leaf_lowest_row[l] != Cell::kSeveralPlaces && cell.position(l * kLeafCapacity) == place;
  };
  std::uint32_t end = leaf;
  while (end < cell.leaf_count() && is_there(end)) ++end;
  return end;
}

void search_copies(const CellQuery& query, std::uint32_t first, std::uint32_t end, SearchScratch& scratch,
                   CellNeighbors& out) {
  constexpr std::uint64_t kNoRow = ~std::uint64_t{0};
  const Neighborhood& what = query.what;
  const Cell& cell = query.cell();
  Neighborhood with_self = what;
  if (what.k != Neighborhood::kUnlimited) ++with_self.k;
  search_place_plainly({query.directory, query.slot, with_self}, cell.position(first), kNoRow, scratch);
  const std::vector<Candidate>& found = scratch.best.finish();
  for (std::uint32_t i = first; i < end; ++i) {
    std::size_t size = 0;
    double ends2 = what.radius2();
    for (const Candidate& c : found) {
      if (c.row == cell.row[i] || size == what.k) continue;
      out.refs.push_back(c.ref);
      if (++size == what.k) ends2 = c.distance2;
    }
    out.reach2.push_back(ends2);
    out.begin.push_back(static_cast<std::uint32_t>(out.refs.size()));
  }
}

}  // namespace pointsweep
