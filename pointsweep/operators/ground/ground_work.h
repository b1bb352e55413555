// SPDX-License-Identifier: MIT
/// The work of `ground` on points in order: first it finds the lowest point of each cell, then it classifies all points
/// by their distance to the surface of the ground.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/raster/cells.h"
#include "pointsweep/raster/ground_surface.h"
#include "pointsweep/raster/lowest_cells.h"

namespace pointsweep {

/// Returns classification, one uint8 per point, classes of LAS: 2 ground, 1 unclassified.
Attribute classification_attribute();

/// Indices of attributes in the values of a point; nullopt for an attribute that the cloud lacks or the options ignore.
struct GroundValues {
  std::optional<std::size_t> return_number, number_of_returns, classification;
};

/// Returns whether a point with these values can be ground.
bool takes_part_in_ground(const GroundOptions& options, const GroundValues& numbers, const double* values);

class GroundWork final : public InOrderWork {
 public:
  /// `values`: number of values of each point. `numbers`: indices of the attributes in these values.
  GroundWork(const GroundOptions& options, const GroundRule& rule, const GroundValues& numbers, std::size_t values,
             const InOrderSetup& setup);
  unsigned rounds() const override { return 2; }
  void add(unsigned round, const OrderedPoints& points, Findings& findings) override;
  void end(unsigned round, Findings& findings) override;
  std::string warning() const override;

 private:
  /// The surface and its slope at a point.
  struct Surface {
    double z, slope;
  };
  struct Cell {
    std::uint64_t row;
    std::size_t column;
  };
  bool takes_part(const double* values) const { return takes_part_in_ground(options_, numbers_, values); }
  std::uint8_t class_of_others(const double* values) const;
  void add_lowest(const OrderedPoints& points);
  void classify(const OrderedPoints& points, Findings& findings);
  Cell cell_of(Vec3 place);
  void open_band(std::size_t number);
  bool is_ground(Vec3 p, Cell cell) const;
  std::optional<Surface> surface_at(Vec3 p, Cell cell) const;
  double surface(Cell cell, int dx, int dy) const;
  double slope(Cell cell, int dx, int dy) const;
  double row_number(Vec3 place) const { return setup_.axis == 0 ? place.x : place.y; }
  double column_number(Vec3 place) const { return setup_.axis == 0 ? place.y : place.x; }

  GroundOptions options_;
  GroundRule rule_;
  GroundValues numbers_;
  std::size_t values_;
  InOrderSetup setup_;
  LowestCells lowest_;
  bool has_points_ = false;
  BandedRows rows_;  ///< rows of the second round
  std::optional<std::size_t> opened_;
  std::optional<CellBand> band_;  ///< the band number `opened_`
  std::optional<SurfaceWindow> surface_;
};

}  // namespace pointsweep
