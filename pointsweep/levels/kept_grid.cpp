// SPDX-License-Identifier: MIT
#include "pointsweep/levels/kept_grid.h"

#include <cmath>
#include <cstddef>

#include "pointsweep/math/box.h"

namespace pointsweep {
namespace {

constexpr std::size_t kLeastBuckets = 1024;
/// Ratio of the width of a cell to the spacing. The margin makes up for rounding: points nearer than the spacing always
/// lie in the same cell or in adjacent cells.
constexpr double kSlack = 1 + 1e-9;

}  // namespace

KeptGrid::KeptGrid(double spacing, Vec3 corner)
    : spacing2_(spacing * spacing),
      cells_per_step_(1 / (spacing * kSlack)),
      corner_(corner),
      first_(kLeastBuckets, kNone) {}

KeptGrid::Cell KeptGrid::cell_of(Vec3 place) const {
  const Vec3 at = cells_per_step_ * (place - corner_);
  return {static_cast<std::int64_t>(std::floor(at.x)), static_cast<std::int64_t>(std::floor(at.y)),
          static_cast<std::int64_t>(std::floor(at.z))};
}

std::size_t KeptGrid::bucket_of(const Cell& cell) const {
  const auto mixed = static_cast<std::uint64_t>(cell[0]) * 0x9e3779b97f4a7c15u +
                     static_cast<std::uint64_t>(cell[1]) * 0xbf58476d1ce4e5b9u +
                     static_cast<std::uint64_t>(cell[2]) * 0x94d049bb133111ebu;
  return static_cast<std::size_t>((mixed ^ mixed >> 32) & (first_.size() - 1));
}

void KeptGrid::add(Vec3 point) {
  if (points_.size() == first_.size()) grow();
  std::uint32_t& first = first_[bucket_of(cell_of(point))];
  next_.push_back(first);
  first = static_cast<std::uint32_t>(points_.size());
  points_.push_back(point);
}

void KeptGrid::grow() {
  first_.assign(4 * first_.size(), kNone);
  for (std::uint32_t i = 0; i < points_.size(); ++i) {
    std::uint32_t& first = first_[bucket_of(cell_of(points_[i]))];
    next_[i] = first;
    first = i;
  }
}

/// Returns whether `use` returns true for a point of the cell, or for a point of another cell in the bucket of the
/// cell.
template <class Use>
bool KeptGrid::any_of_cell(const Cell& cell, const Use& use) const {
  for (std::uint32_t i = first_[bucket_of(cell)]; i != kNone; i = next_[i])
    if (use(points_[i])) return true;
  return false;
}

bool KeptGrid::covers(Vec3 place) const {
  const auto [x, y, z] = cell_of(place);
  // 0 is first, since the cell of the place itself holds the covering point most often.
  constexpr std::int64_t kNear[] = {0, -1, 1};
  for (const std::int64_t dx : kNear)
    for (const std::int64_t dy : kNear)
      for (const std::int64_t dz : kNear)
        if (any_of_cell({x + dx, y + dy, z + dz}, [&](Vec3 p) { return distance2(p, place) < spacing2_; })) return true;
  return false;
}

void KeptGrid::find_near(const Box& box, std::vector<Vec3>& near) const {
  near.clear();
  Cell lo = cell_of(box.lo), hi = cell_of(box.hi);
  for (std::size_t axis = 0; axis < 3; ++axis) --lo[axis], ++hi[axis];
  const std::int64_t cells = (hi[0] - lo[0] + 1) * (hi[1] - lo[1] + 1) * (hi[2] - lo[2] + 1);
  const auto take = [&](Vec3 p) {
    if (distance2(box, p) < spacing2_) near.push_back(p);
    return false;
  };
  if (cells > static_cast<std::int64_t>(points_.size())) {
    for (const Vec3 p : points_) take(p);
    return;
  }
  for (Cell cell = lo; cell[0] <= hi[0]; ++cell[0])
    for (cell[1] = lo[1]; cell[1] <= hi[1]; ++cell[1])
      for (cell[2] = lo[2]; cell[2] <= hi[2]; ++cell[2]) any_of_cell(cell, take);
}

}  // namespace pointsweep
