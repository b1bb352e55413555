// SPDX-License-Identifier: MIT
/// Generated clouds of known geometry and any size. Programs that include this header link pointsweep::shapes.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/export.h"
#include "pointsweep/geometry.h"
#include "pointsweep/reader.h"
#include "pointsweep/writer.h"

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

struct NamedShape {
  std::string name;
  std::string meaning;  ///< one line about size and density
};

/// Returns the shapes, in the order of their presentation.
POINTSWEEP_EXPORT std::vector<NamedShape> shapes();

/// Returns a reader of a cloud that is stored nowhere: points in random order with the fields x y z and, if the shape
/// has normals, nx ny nz (float32). Row i depends only on the shape, the options except `count`, and i: not on the size
/// of a call, on threads or on the processor. `info().bounds` contains every point. Throws UsageError, with the known
/// shapes, for an unknown shape, and for a value out of range. 5 to 50 million points a second and core.
POINTSWEEP_EXPORT std::unique_ptr<Reader> generated_points(std::string_view shape, const Sampling& sampling);

/// Writes all points of a generated cloud and completes the output. Points are made on `threads` threads, 0 for one per
/// core, while the points before them are written. `progress` gets the number of points written; it may throw to end
/// the work.
POINTSWEEP_EXPORT void write_generated(Reader& points, Writer& writer, unsigned threads,
                                       const std::function<void(std::uint64_t done)>& progress);

}  // namespace pointsweep
