// SPDX-License-Identifier: MIT
/// How many points would wait in memory if slabs were made on demand, as far as boxes tell before any point is read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "pointsweep/math/box.h"
#include "pointsweep/points/row_box.h"

namespace pointsweep {

/// The most points decoded and not yet handed over at any time, if all rows of a box are decoded when the sweep reaches
/// where it begins, and slabs of `slab_points` are handed over, `ahead` of them made at once. `sample`: of the points,
/// which tells where slabs begin. Never above `points`.
std::uint64_t estimate_waiting(std::span<const RowBox> boxes, int axis, std::span<const Vec3> sample,
                               std::uint64_t points, std::uint64_t slab_points, std::size_t ahead);

}  // namespace pointsweep
