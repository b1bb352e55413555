// SPDX-License-Identifier: MIT
/// A generated cloud of any size, read like a file although it is stored nowhere.
#pragma once

#include <cstdint>
#include <memory>

#include "pointsweep/reader.h"
#include "pointsweep/shapes/registry.h"

namespace pointsweep {

/// Options for making a cloud of the points of a shape. Lengths are in metres.
struct Sampling {
  std::uint64_t count = 0;
  std::uint64_t seed = 1;
  double noise = 0;         ///< standard deviation of Gaussian noise in each of x, y and z; normals get no noise
  double outliers = 0;      ///< probability in [0, 1] that a point lies anywhere in the outlier box, with normal 0
  double outlier_box = 20;  ///< size of the outlier box as a multiple of the shape's box, about the same centre
  Vec3 origin = {};         ///< added to every position, for coordinates as large as on maps
  bool float64 = false;     ///< coordinates as float64 instead of float32
};

/// Reads points with the fields x y z and, if the shape has normals, nx ny nz (float32). Row i depends only on shape,
/// seed and i: not on the count, on the size of a call, on threads or on the processor. Rows are in random order.
/// `info().bounds` contains every point.
class ShapeReader final : public Reader {
 public:
  /// Throws UsageError for a value out of range.
  ShapeReader(std::shared_ptr<const Shape> shape, const Sampling& sampling);

  /// Makes the records on all threads, 5 to 50 million points a second and core.
  std::size_t read(std::uint64_t row, std::span<std::byte> records) override;

 private:
  SurfacePoint point(std::uint64_t row) const;
  void store(std::uint64_t row, std::byte* record) const;

  std::shared_ptr<const Shape> shape_;
  Sampling sampling_;
  Box outlier_box_;
};

}  // namespace pointsweep
