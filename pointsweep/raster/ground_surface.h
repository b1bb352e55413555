// SPDX-License-Identifier: MIT
/// The surface of the ground as a raster, after T. J. Pingel, K. C. Clarke and W. A. McBride, "An improved simple
/// morphological filter for the terrain classification of airborne LIDAR data" (ISPRS Journal of Photogrammetry and
/// Remote Sensing 77, 2013), with rows that come one after another and holes filled locally (row_filters.h).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "pointsweep/points/scratch.h"
#include "pointsweep/raster/cells.h"
#include "pointsweep/raster/lowest_cells.h"

namespace pointsweep {

struct GroundRule {
  static constexpr double kPitSlope = 5;
  double cell;         ///< edge of a cell, length
  double slope;        ///< steepest slope of the ground, rise over run
  std::size_t radius;  ///< radius of the largest disk, in cells

  /// Returns half of the least height by which a cell is marked as a pit or an object. Filled and opened surfaces stay
  /// within the range of the minima, apart from rounding. If that range is smaller than the returned length, as for a
  /// distant outlier, no cell is marked.
  double least_height() const { return std::min(slope, kPitSlope) * cell / 2; }
  /// Returns the distance, in cells, of the farthest cells from which a hole is filled. This distance spans the cells
  /// that the largest disk erases, in any direction.
  std::size_t reach() const { return 3 * radius + 3; }
  /// Returns the rule for strips without points. The ground on the two sides of a strip is independent if they are
  /// AxisRule::most cells apart.
  AxisRule axis_rule() const { return {reach(), 2 * reach() + radius + 2}; }
};

/// Returns the surface of the ground. 1. The raster of minima is filled. 2. The raster is turned upside down and opened
/// with a disk of radius 1 (in cells). Cells that lie below this opening by more than 5 * cell are marked as pits. 3.
/// The filled surface is opened with disks of the radii r = 1, 2, ... `radius` in turn, each time from the surface
/// opened last. Cells that an opening lowers by more than slope * (cell * r) are marked as objects. 4. The raster of
/// minima is filled again, without the marked cells.
///
/// Filters whose rows do not fit in `memory_bytes` together run one after another, with their surfaces in scratch. The
/// surface does not depend on `memory_bytes`. `lowest` must outlive the returned stream. Throws the Error of
/// require_ground_memory().
std::unique_ptr<RowStream> ground_surface(const CellBand& lowest, const GroundRule& rule, std::uint64_t memory_bytes,
                                          const MakeScratch& make_scratch);

/// Throws Error if a single filter over `columns` columns does not fit in `memory_bytes`.
void require_ground_memory(const GroundRule& rule, std::size_t columns, std::uint64_t memory_bytes);
/// Returns the least memory that suffices for `columns` columns, in bytes.
std::uint64_t least_ground_bytes(const GroundRule& rule, std::size_t columns);

/// The few rows of a surface around the row of the current points.
class SurfaceWindow {
 public:
  /// Keeps at least the row of move_to(), and the rows up to `around` before and after it, in memory.
  SurfaceWindow(std::unique_ptr<RowStream> from, std::size_t around) : from_(std::move(from)), around_(around) {}
  /// Moves the window to a row, which must not be earlier than the row of the last call.
  void move_to(std::uint64_t row);
  /// Returns the value of a cell; kNoCell outside of the raster or of the rows in memory.
  double at(std::uint64_t row, std::size_t column) const {
    const std::size_t columns = from_->columns();
    if (row < first_ || row - first_ >= rows_ || column >= columns) return kNoCell;
    return values_[static_cast<std::size_t>(row - first_) * columns + column];
  }

 private:
  std::unique_ptr<RowStream> from_;
  std::size_t around_;
  std::uint64_t first_ = 0;  ///< number of the first row in memory
  std::size_t rows_ = 0;
  bool ended_ = false;
  std::vector<double> values_;
  CellRows block_;
};

}  // namespace pointsweep
