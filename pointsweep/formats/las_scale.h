// SPDX-License-Identifier: MIT
/// The finest scale at which LAS, which stores coordinates as 32-bit integers, can hold real coordinates, and the grid
/// and times of points that come from LAS files.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/math/box.h"

namespace pointsweep {

struct PositionFields;

/// The largest coordinate, in steps of the scale from the offset.
inline constexpr double kMostLasSteps = 2147483647;

/// An offset that is chosen for a given scale lies a multiple of this many steps from 0 or from a given offset, so that
/// it has few digits.
inline constexpr double kRoundSteps = 1000;

/// The grid of integer coordinates: a coordinate is integer * scale + offset.
struct LasQuantization {
  Vec3 scale{1, 1, 1}, offset;
};

/// Returns the grid of three scaled coordinates.
LasQuantization grid_of(const PositionFields& fields);

/// Returns whether LAS can store `value` on this grid to within half a step.
bool las_grid_reaches(double value, double scale, double offset);

/// Returns whether `value` lies a whole number of steps, at most kMostLasSteps, from `offset`, to within a few units in
/// the last place of `value` and `offset`.
bool is_on_las_grid(double value, double scale, double offset);

/// Returns scale and offset of each axis for coordinates inside `bounds`. The scale is the smallest power of ten whose
/// steps reach both ends from the offset in 31 bits, but no finer than the spacing of doubles at the largest coordinate
/// and than 1e-12 of half the longest extent (1e-9 for a single point); the offset is a round number near the middle,
/// or the lower end of an axis that is flat at this scale. An axis of extent E whose scale the 31 bits decide loses at
/// most 1.3e-9 E (1.3 mm on 1,000 km), which is less than the steps of float32 coordinates of magnitude E.
LasQuantization las_quantization(const Box& bounds);

/// Returns `grid` with its offsets moved by whole steps where 32 bits do not reach `bounds`. An axis that is too long
/// for its scale gets the scale and offset of las_quantization().
LasQuantization las_grid_within(const LasQuantization& grid, const Box& bounds);

/// Returns the grid for points that stages have moved. If 32 bits do not reach `bounds` on an axis of `grid`, the
/// offset of that axis moves by whole steps, and its scale stays. An axis that is too long for its scale keeps its
/// offset: not all of its points fit.
LasQuantization las_grid_for_moved(const LasQuantization& grid, const Box& bounds);

/// Returns `grid` with the multiple of 1,000 steps nearest to the middle of `bounds` as offset.
LasQuantization las_grid_in_the_middle(const LasQuantization& grid, const Box& bounds);

/// Returns the smallest powers of ten at which 32 bits reach `bounds` from this offset, and that are no finer than the
/// scale of las_quantization().
Vec3 las_scale_from(Vec3 offset, const Box& bounds);

class Reader;

/// The meaning of the coordinates, times and classes of a LAS file. PLY outputs state it, so that LAS made from them has
/// the same grid, times and overlap flags.
struct LasOrigin {
  LasQuantization grid;        ///< scale and offset of the integer coordinates
  bool has_time = false;       ///< the points have a GPS time
  bool standard_time = false;  ///< GPS times are adjusted standard GPS time, not seconds of the GPS week
  /// Class 12 means the overlap of flight lines, as in LAS files of point formats 0 to 5.
  bool overlap_is_class_12 = false;
};

/// Returns the common origin of the inputs that are LAS or were made from LAS: the finest scale of each axis with the
/// offset of the first input that has it, and the kind of time of the first input with a time. Class 12 means overlap
/// if it does in all of these inputs. A warning names an input with the other kind of time. Returns none if no input is
/// LAS or was made from LAS.
std::optional<LasOrigin> common_las_origin(const std::vector<std::shared_ptr<Reader>>& readers,
                                           std::vector<std::string>& warnings);

}  // namespace pointsweep
