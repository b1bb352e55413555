// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <limits>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/search/cell_search.h"

namespace pointsweep {
namespace {

struct NearLeaf {
  double distance2;
  std::uint32_t leaf;
  friend bool operator<(const NearLeaf& a, const NearLeaf& b) {
    return a.distance2 != b.distance2 ? a.distance2 < b.distance2 : a.leaf < b.leaf;
  }
};

void search_leaf(const Cell& cell, std::uint32_t slot, std::uint32_t leaf, Vec3 p, std::uint64_t self_row,
                 BestList& best) {
  const std::uint32_t b = leaf * kLeafCapacity;
  std::array<double, kLeafCapacity> d2;
  for (std::uint32_t i = 0; i < kLeafCapacity; ++i) {
    const double dx = cell.x[b + i] - p.x, dy = cell.y[b + i] - p.y, dz = cell.z[b + i] - p.z;
    d2[i] = (dx * dx + dy * dy) + dz * dz;
  }
  const std::uint32_t size = cell.leaf_size(leaf);
  for (std::uint32_t i = 0; i < size; ++i) {
    if (d2[i] <= best.limit() && cell.row[b + i] != self_row) {
      best.offer({d2[i], cell.position(b + i), cell.row[b + i], make_ref(slot, b + i)});
    }
  }
}

/// Factor that makes the computed squared distance to a leaf box a lower bound. Boxes are rounded outward in single
/// precision, so that only the last bits of the subtraction of the origin can make the result too large.
constexpr double kSafety = 1 - 1e-12;

/// Returns whether the points of a leaf or cell that begins with point `first` may belong to the list. `lowest_row` is
/// kSeveralPlaces, for which the answer is true, or the lowest row of points that are all at one place. Once the list
/// holds k points nearer than the point with that row, these points are skipped, so that a million copies of one point
/// cost little.
bool wants_place(const Cell& cell, std::uint32_t first, std::uint64_t lowest_row, Vec3 p, const BestList& best) {
  if (lowest_row == Cell::kSeveralPlaces) return true;
  const Vec3 place = cell.position(first);
  return best.wants({distance2(place, p), place, lowest_row, 0});
}

void search_cell(const Cell& cell, std::uint32_t slot, Vec3 p, std::uint64_t self_row, BestList& best) {
  const Vec3 q = p - cell.origin;
  std::array<NearLeaf, kCellCapacity / kLeafCapacity> near;
  std::size_t count = 0;
  const std::uint32_t leaves = cell.leaf_count();
  for (std::uint32_t l = 0; l < leaves; ++l) {
    const double dx = std::max({double{cell.leaf_box[0][l]} - q.x, q.x - double{cell.leaf_box[3][l]}, 0.0});
    const double dy = std::max({double{cell.leaf_box[1][l]} - q.y, q.y - double{cell.leaf_box[4][l]}, 0.0});
    const double dz = std::max({double{cell.leaf_box[2][l]} - q.z, q.z - double{cell.leaf_box[5][l]}, 0.0});
    const double d2 = ((dx * dx + dy * dy) + dz * dz) * kSafety;
    if (d2 <= best.limit()) near[count++] = {d2, l};
  }
  std::sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count));
  for (std::size_t i = 0; i < count; ++i) {
    if (near[i].distance2 > best.limit()) return;
    const std::uint32_t leaf = near[i].leaf;
    if (wants_place(cell, leaf * kLeafCapacity, cell.leaf_lowest_row[leaf], p, best)) {
      search_leaf(cell, slot, leaf, p, self_row, best);
    }
  }
}

/// Offers to `best` every point of the cells in `near` that may belong to the list, except the point with row
/// `self_row`. `near` is sorted by distance from a box that contains `p`, as CellDirectory::find returns it.
void search_exact(const CellDirectory& directory, const std::vector<CellDirectory::Near>& near, Vec3 p,
                  std::uint64_t self_row, BestList& best) {
  for (const CellDirectory::Near& candidate : near) {
    stop_if_cancelled();
    if (candidate.distance2 > best.limit()) return;
    const Cell& cell = directory.cell(candidate.slot);
    if (distance2(cell.box, p) <= best.limit() && wants_place(cell, 0, cell.lowest_row, p, best)) {
      search_cell(cell, candidate.slot, p, self_row, best);
    }
  }
}

}  // namespace

void order_runs(const CellDirectory& directory, Vec3 p, std::uint64_t close_to_next, NeighborRef* refs) {
  std::array<Candidate, 64> run;
  while (close_to_next != 0) {
    const int begin = std::countr_zero(close_to_next);
    const int length = std::countr_one(close_to_next >> begin) + 1;
    const auto size = static_cast<std::size_t>(length);
    for (std::size_t i = 0; i < size; ++i)
      insert_sorted(candidate_from(directory, refs[begin + i], p), run.data(), i, run.size());
    for (std::size_t i = 0; i < size; ++i) refs[begin + i] = run[i].ref;
    close_to_next &= ~(((std::uint64_t{1} << (length - 1)) - 1) << begin);
  }
}

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

void search_place_plainly(const CellQuery& query, Vec3 place, std::uint64_t self_row, SearchScratch& scratch) {
  for (;;) {
    scratch.best.start(query.what);
    search_exact(query.directory, scratch.near.cells, place, self_row, scratch.best);
    if (scratch.best.limit() <= scratch.near.reach2) return;
    scratch.near.find(query, std::max(2 * scratch.best.limit(), std::numeric_limits<double>::min()));
  }
}

void search_point_plainly(const CellQuery& query, std::uint32_t i, SearchScratch& scratch) {
  search_place_plainly(query, query.cell().position(i), query.cell().row[i], scratch);
}

void append_best(const Neighborhood& what, SearchScratch& scratch, CellNeighbors& out) {
  const std::vector<Candidate>& found = scratch.best.finish();
  for (const Candidate& c : found) out.refs.push_back(c.ref);
  out.reach2.push_back(found.size() == what.k ? found.back().distance2 : what.radius2());
  out.begin.push_back(static_cast<std::uint32_t>(out.refs.size()));
}

std::uint32_t search_plainly(const CellQuery& query, const CellSubset& points, std::uint64_t most,
                             SearchScratch& scratch, CellNeighbors& out) {
  scratch.near.find(query, 0);
  std::uint32_t n = 0;
  for (; n < points.size() && (n == 0 || out.refs.size() < most); ++n) {
    stop_if_cancelled();
    search_point_plainly(query, points[n], scratch);
    append_best(query.what, scratch, out);
  }
  return n;
}

}  // namespace pointsweep
