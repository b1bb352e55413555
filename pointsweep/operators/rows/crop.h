// SPDX-License-Identifier: MIT
/// Keeping the points inside a box or polygons.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/polygons/polygon_index.h"

namespace pointsweep {

/// Keeps a point if it lies in the box and in a polygon; with CropOptions::outside, keeps all other points instead.
/// Edges and faces count as inside in both cases. A point is in no box or polygon if a coordinate needed for the test
/// is not finite.
class Crop final : public SelectOperator {
 public:
  /// Reads the file with polygons, if there is one. Throws Error if it cannot be read or does not match
  /// CropOptions::checksum, and UsageError, beginning with `place`, if no option states a region or the bounds are
  /// invalid.
  explicit Crop(CropOptions options, std::string place = "crop");
  std::string name() const override { return "crop"; }
  void keep(const Neighborhoods& points, std::span<std::uint8_t> kept) const override;
  /// Returns the options, with the checksum of the file that was read.
  const CropOptions& options() const { return options_; }
  /// Returns the box of the bounds in x and y, or, without bounds, the box of the polygons. Its z is 0. Returns nullopt
  /// with CropOptions::outside.
  std::optional<Box> extent() const override;

 private:
  void read_polygons();
  bool is_inside(Vec3 p) const;

  CropOptions options_;
  std::string place_;
  std::vector<Polygon> polygons_;
  std::optional<PolygonIndex> index_;
};

}  // namespace pointsweep
