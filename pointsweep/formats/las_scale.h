// SPDX-License-Identifier: MIT
/// The finest scale at which LAS, which stores coordinates as 32-bit integers, can hold real coordinates.
#pragma once

#include "pointsweep/geometry.h"
#include "pointsweep/math/box.h"

namespace pointsweep {

/// The largest coordinate, in steps of the scale from the offset.
inline constexpr double kMostLasSteps = 2147483647;

struct LasQuantization {
  Vec3 scale{1, 1, 1}, offset;
};

/// Returns whether LAS can store `value` on this grid to within half a step.
bool las_grid_reaches(double value, double scale, double offset);

/// Returns whether `value` is a whole number of steps of this grid, to within a few units in the last place of a
/// double.
bool is_on_las_grid(double value, double scale, double offset);

/// Scale and offset of each axis for coordinates inside `bounds`: the scale is the smallest power of ten whose steps
/// reach both ends from the offset in 31 bits, but no finer than doubles of that size are; the offset is a round
/// number near the middle. An axis of extent E loses at most 1.3e-9 E (1.3 mm on 1,000 km), which is less than the
/// steps of float32 coordinates of magnitude E.
LasQuantization las_quantization(const Box& bounds);

/// `grid` with its offsets moved by whole steps where `bounds` are too far away for 32 bits; an axis that is too long
/// for its scale is as las_quantization() has it.
LasQuantization las_grid_within(const LasQuantization& grid, const Box& bounds);

/// The grid for points that stages have moved: `grid`, or where `bounds` are too far away for 32 bits the same scale
/// with another offset, whole steps from the first. An axis that is too long for its scale keeps its offset: its points
/// do not fit.
LasQuantization las_grid_for_moved(const LasQuantization& grid, const Box& bounds);

}  // namespace pointsweep
