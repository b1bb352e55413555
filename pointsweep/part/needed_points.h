// SPDX-License-Identifier: MIT
/// The points that an in-order operator has to know in a part of a cloud: those of one tile, and those of others that
/// decide about them (Reach of in_order_operator.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/order/source.h"
#include "pointsweep/part/tile_reader.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

struct NeededPoints {
  PointSource source;            ///< records of the scratch, whose rows are those of their cloud; in no order
  std::uint64_t first_row = 0;   ///< of the tile
  std::uint64_t own_points = 0;  ///< of the tile, with a place
  std::uint64_t points = 0;      ///< with a place
  /// InOrderSetup::may_lack; empty: all points of the cloud are among them. Thread-safe.
  std::function<bool(Vec3 position, double distance)> may_lack = {};
};

/// Returns the points that an operator of this reach has to know for what it finds about tile `number`, among them all
/// of the tile. `working`: Stream::record_schema() of the tile when it was stored. The source borrows the arguments.
NeededPoints needed_points(const Storage& scratch, const TileCatalogue& tiles, std::size_t number,
                           const Schema& working, const InOrderOperator& op, const Reach& reach);

/// Returns the points of another cloud that the operator has to know for what it finds about tile `number`. `working`:
/// of the files of the other cloud when they were stored.
NeededPoints needed_of_other(const Storage& scratch, const TileCatalogue& tiles, std::size_t number,
                             const TileCatalogue& other, const Schema& working, const InOrderOperator& op);

}  // namespace pointsweep
