// SPDX-License-Identifier: MIT
/// The ground of a cloud by SMRF (Pingel, Clarke and McBride 2013) on a raster of the whole cloud, as defined in
/// docs/operators.md, and heights above points of the ground.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

struct GroundParameters {
  double cell, slope, window, threshold, scalar;

  std::size_t radius() const;                             ///< radius of the largest disk, in cells
  std::size_t reach() const { return 3 * radius() + 3; }  ///< reach of the filling of holes, in cells
};

/// Returns the number of the cell in which a coordinate lies, as float64.
double cell_number(double coordinate, double cell);

/// The numbers of cells along one axis, with wide empty strips shortened: a strip across which no filter reaches keeps
/// only as many cells as the filters need.
class CellNumbers {
 public:
  /// `numbers`: the cell number of each point, in any order and with repetitions.
  CellNumbers(std::vector<double> numbers, std::size_t reach, std::size_t radius);
  std::size_t count() const { return count_; }
  /// Returns the index, below count(), of a cell that has points.
  std::size_t place(double number) const;

 private:
  std::vector<double> numbers_;
  std::vector<std::size_t> places_;
  std::size_t count_ = 0;
};

class GroundRaster {
 public:
  /// Bytes of memory for a cell while the surface is computed.
  static constexpr std::size_t kCellBytes = 56;

  /// Makes the raster. `columns`, `rows`: numbers, along x and y, of the cells of all points that the filter uses.
  GroundRaster(const GroundParameters& parameters, CellNumbers columns, CellNumbers rows);
  void add(double x, double y, double z);
  /// Computes the surface. Must be called after the last point.
  void finish();
  /// Returns whether a point that was added is ground; nothing if rounding decides.
  std::optional<bool> is_ground(double x, double y, double z) const;

 private:
  using Cells = std::vector<double>;  ///< value of each cell, at index at(column, row); NaN for a cell without one
  std::size_t at(std::size_t column, std::size_t row) const { return row * columns_.count() + column; }
  double surface(std::size_t column, std::size_t row) const { return surface_[at(column, row)]; }
  double slope(std::size_t column, std::size_t row) const;
  Cells filled(const Cells& cells) const;
  Cells least_of_disks(const Cells& cells, std::size_t radius) const;
  Cells opened(const Cells& cells, std::size_t radius) const;

  GroundParameters parameters_;
  CellNumbers columns_, rows_;
  Cells lowest_, surface_;
};

/// A point of the ground near another point.
struct GroundPoint {
  double distance2;  ///< squared distance in x and y
  double z;
};

/// Returns the height of z above the ground points `nearest`, nearest first: z - Σ w_j z_j / Σ w_j with w_j = 1 / d_j²;
/// z - z_1 if d_1 = 0; NaN without ground points.
Estimate height_above(double z, std::span<const GroundPoint> nearest);

}  // namespace pointsweep::formulas
