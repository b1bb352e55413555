// SPDX-License-Identifier: MIT
#include "pointsweep/search/exact_search.h"

#include <algorithm>
#include <array>

#include "pointsweep/cancellation.h"

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

/// Leaf boxes are rounded outward in single precision; the distance to them in double is a lower bound up to the last
/// bits of the subtraction of the origin, which this factor covers.
constexpr double kSafety = 1 - 1e-12;

/// Points all at the place of point `first`, the lowest of their rows given: a million copies of one point are passed
/// over as soon as the k lowest rows are known. Points at several places are always wanted.
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

}  // namespace

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

}  // namespace pointsweep
