// SPDX-License-Identifier: MIT
/// A sample of a cloud, its bounds and its number of points, found in one pass before the cloud is drawn.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/render/extents.h"
#include "pointsweep/render/point_color.h"
#include "pointsweep/render/row_stretches.h"

namespace pointsweep {

/// A block of the cloud's points: records and positions.
struct PointBlock {
  std::uint64_t first;  ///< number of its first point among those that are looked at
  std::size_t size;
  const std::byte* records;
  std::size_t stride;
  const double *x, *y, *z;

  Vec3 position(std::size_t i) const { return {x[i], y[i], z[i]}; }
  const std::byte* record(std::size_t i) const { return records + i * stride; }
};

/// Reads these rows of the cloud once, in their order.
void for_each_block(InputCloud& cloud, const RowStretches& rows, const std::function<void(const PointBlock&)>& visit);

struct CloudSample {
  Box bounds;                   ///< bounding box of the finite points
  std::uint64_t finite = 0;     ///< points
  std::vector<Vec3> positions;  ///< of at most 65,536 finite points, one from each of as many equal stretches of rows
  std::vector<std::byte> records;  ///< of these positions, one record after another
};

/// Samples the cloud, and shows every record to `color` and every finite point to `views`.
CloudSample sample_cloud(InputCloud& cloud, const RowStretches& rows, PointColor& color, PossibleViews& views,
                         const std::function<void(std::uint64_t done)>& progress);

}  // namespace pointsweep
