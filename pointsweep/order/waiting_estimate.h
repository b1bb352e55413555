// SPDX-License-Identifier: MIT
/// Estimates from the boxes of a file how many points wait in memory if slabs are made on demand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "pointsweep/math/box.h"
#include "pointsweep/points/row_box.h"

namespace pointsweep {

/// Returns the largest number of points that are decoded and not yet handed over at any time. Assumes that all rows of
/// a box are decoded when the sweep reaches the place where the box begins, and that slabs of `slab_points` are handed
/// over, of which `ahead` are made at once. `sample` is a sample of the points, from which the places of the slabs are
/// estimated. The result is at most `points`.
std::uint64_t estimate_waiting(std::span<const RowBox> boxes, int axis, std::span<const Vec3> sample,
                               std::uint64_t points, std::uint64_t slab_points, std::size_t ahead);

}  // namespace pointsweep
