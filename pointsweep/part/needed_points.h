// SPDX-License-Identifier: MIT
/// The points that an in-order operator has to know in a part of a cloud: the points of one tile, and the points of
/// other tiles on which its results for that tile depend (Reach of in_order_operator.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/order/source.h"
#include "pointsweep/part/tile_catalogue.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

struct NeededPoints {
  PointSource source;           ///< records in no particular order, with rows of the cloud to which the points belong
  std::uint64_t first_row = 0;  ///< first row of the tile in its cloud; 0 for points of another cloud
  /// Number of points of the tile with finite coordinates; 0 for points of another cloud.
  std::uint64_t own_points = 0;
  std::uint64_t points = 0;  ///< number of points of the source with finite coordinates
  /// The function for InOrderSetup::may_lack; empty if no point that can change a result is missing. Thread-safe.
  std::function<bool(Vec3 position, double distance)> may_lack = {};
};

/// Returns the points that an operator with `reach` has to know for its results in tile `number`, all points of the
/// tile included. `working`: Stream::record_schema() of the tile when it was stored. The source borrows `scratch` and
/// `tiles`.
NeededPoints needed_points(const Storage& scratch, const TileCatalogue& tiles, std::size_t number,
                           const Schema& working, const InOrderOperator& op, const Reach& reach);

/// Returns the points of the cloud `other` that the operator has to know for its results in tile `number`. `working`:
/// Stream::record_schema() of the files of the other cloud when they were stored. If no point is needed, returns the
/// points of one block of `other`, if it has any. The source borrows `scratch` and `other`.
NeededPoints needed_of_other(const Storage& scratch, const TileCatalogue& tiles, std::size_t number,
                             const TileCatalogue& other, const Schema& working, const InOrderOperator& op);

}  // namespace pointsweep
