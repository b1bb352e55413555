// SPDX-License-Identifier: MIT
/// The choice of the rows that are drawn, and a first pass over these rows, which finds the bounds, the number and a
/// sample of their finite points before they are drawn.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/math/box.h"
#include "pointsweep/render/point_color.h"
#include "pointsweep/render/view.h"

namespace pointsweep {

/// The rows [begin, end).
struct RowStretch {
  std::uint64_t begin, end;
};

struct RowStretches {
  std::vector<RowStretch> stretches;  ///< stretches of rows, ascending and without overlap
  std::uint64_t count = 0;            ///< number of rows in all stretches
};

RowStretches all_rows(const InputCloud& cloud);

/// Returns the rows that can be read and drawn in about `seconds`: all rows, or every n-th stretch of rows. A stretch
/// is a chunk of the file; without chunks it has 256 rows, or 8,192 rows if the reader has no decoder. Reads a few
/// stretches to measure the time per row.
RowStretches rows_within(InputCloud& cloud, double seconds);

/// Extents of a cloud along the axes of a camera, relative to the origin of the camera.
struct Extents {
  double lo_x = Box::kInf, hi_x = -Box::kInf, lo_y = Box::kInf, hi_y = -Box::kInf;
};

/// The extents of all points in each view that may be chosen after the first pass over the points. Cost: two dot
/// products per point and view; there are at most 12 views.
class PossibleViews {
 public:
  /// `angles` and `up`: what is known before the pass. If one is absent, all values that the program may choose are
  /// possible.
  PossibleViews(std::optional<Angles> angles, std::optional<Up> up);
  void include(Vec3 p);
  /// Returns the extents for one of the possible views and a camera of that view. At least one point must be included.
  Extents extents(const View& view, const Camera& camera) const;

 private:
  struct Possible {
    View view;
    Camera camera;
    Extents extents;
  };
  std::optional<Vec3> origin_;  ///< first point, the origin of projections, so that map coordinates lose no digits
  std::vector<Possible> views_;
};

/// A block of the cloud's points: records and positions.
struct PointBlock {
  std::uint64_t first;  ///< number of the first point of the block among all points that are read
  std::size_t size;
  const std::byte* records;
  std::size_t stride;
  const double *x, *y, *z;

  Vec3 position(std::size_t i) const { return {x[i], y[i], z[i]}; }
  const std::byte* record(std::size_t i) const { return records + i * stride; }
};

/// Reads `rows` of the cloud once, in ascending order, and calls visit(block) for each block.
void for_each_block(InputCloud& cloud, const RowStretches& rows, const std::function<void(const PointBlock&)>& visit);

struct CloudSample {
  Box bounds;                ///< bounding box of the finite points
  std::uint64_t finite = 0;  ///< number of finite points
  /// The finite ones among min(65,536, number of rows) sampled points, one from each of as many stretches of rows,
  /// whose lengths differ by at most 1.
  std::vector<Vec3> positions;
  std::vector<std::byte> records;  ///< records of the points of `positions`, one after another
};

/// Samples the cloud in one pass, which calls color.look_at() for every record and views.include() for every finite
/// point.
CloudSample sample_cloud(InputCloud& cloud, const RowStretches& rows, PointColor& color, PossibleViews& views,
                         const std::function<void(std::uint64_t done)>& progress);

}  // namespace pointsweep
