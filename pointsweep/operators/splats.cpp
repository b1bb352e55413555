// SPDX-License-Identifier: MIT
#include "pointsweep/operators/splats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "pointsweep/math/batch.h"
#include "pointsweep/math/saturated_float.h"
#include "pointsweep/operators/curvature.h"
#include "pointsweep/operators/tangent_plane.h"
#include "pointsweep/operators/weighted_neighborhood.h"

namespace pointsweep {
namespace {

constexpr std::size_t kHeld = 8;         // neighbours inside a splat
constexpr double kThinnest = 1.0 / 8.0;  // least ratio

/// Shape of an ellipse without its size.
struct Ellipse {
  Vec3 major, minor;  // unit, in the tangent plane
  double ratio;

  Ellipse(Vec3 normal, Vec3 axis, double flatness)
      : major(axis), minor(cross(normal, axis)), ratio(std::clamp(flatness, kThinnest, 1.0)) {}
  /// Square of the major semi-axis of the ellipse through p_i + offset, projected into its plane.
  double reach2(Vec3 offset) const {
    const double along = dot(offset, major), across = dot(offset, minor) / ratio;
    return along * along + across * across;
  }
};

/// `e` is that of M_i.
Ellipse ellipse_of_positions(Vec3 normal, const Eigen3& e) {
  const double flatness = e.value[2] > 0 ? std::sqrt(std::max(e.value[1], 0.0) / e.value[2]) : 1;
  return {normal, tangent(normal, e.vector[2], e.vector[1]), flatness};
}

/// Eigenvectors of M_i of a few points at a time, side by side.
struct Chunk {
  static constexpr std::size_t kPoints = 64;
  std::array<Symmetric3, kPoints> moments;
  std::array<Eigen3, kPoints> eigen;

  void gather(const Neighborhoods& in, std::size_t first, std::vector<double>& theta) {
    const std::size_t size = std::min(kPoints, in.size() - first);
    for (std::size_t c = 0; c < size; ++c) moments[c] = WeightedNeighborhood(in, first + c).moments(theta);
    batch_eigen_symmetric3({moments.data(), size}, {eigen.data(), size});
  }
};

/// The eight least of what it is shown.
class Least {
 public:
  Least() { least_.fill(std::numeric_limits<double>::infinity()); }
  void show(double value) {
    ++seen_;
    if (!(value < least_.back())) return;
    std::size_t at = kHeld - 1;
    for (; at > 0 && value < least_[at - 1]; --at) least_[at] = least_[at - 1];
    least_[at] = value;
  }
  std::size_t held() const { return std::min(seen_, kHeld); }
  double last() const { return least_[held() - 1]; }

 private:
  std::array<double, kHeld> least_;
  std::size_t seen_ = 0;
};

/// Major semi-axis, scaled as the offsets are; 0 without a neighbour that is off p_i in the plane.
double fitted_length(const Ellipse& ellipse, const WeightedNeighborhood& near) {
  Least least;
  for (std::size_t j = 0; j < near.size(); ++j) {
    const double reach2 = ellipse.reach2(near.offset(j));
    if (reach2 > 0) least.show(reach2);
  }
  if (least.held() == 0) return 0;
  return std::sqrt(least.last() * (double(kHeld) / double(least.held())));
}

}  // namespace

Attribute splat_axis_attribute() {
  return {
      "splat_axis", Type::f32, Kind::vector, {"splat_x", "splat_y", "splat_z"}, "1", "unit major axis of the splat"};
}
Attribute splat_length_attribute() {
  return scalar("splat_length", Type::f32, "length", "major semi-axis of the splat");
}
Attribute splat_ratio_attribute() {
  return scalar("splat_ratio", Type::f32, "1", "minor over major semi-axis of the splat, (0, 1]");
}

Contract Splats::contract() const {
  Contract c;
  c.reads = {normal_attribute()};
  if (options_.axes == SplatAxes::curvature)
    c.reads.insert(c.reads.end(), {k1_direction_attribute(), k1_attribute(), k2_attribute()});
  c.makes = {splat_axis_attribute(), splat_length_attribute(), splat_ratio_attribute()};
  return c;
}

void Splats::apply(const Neighborhoods& in, Columns& out) const {
  const bool along_ridges = options_.axes == SplatAxes::curvature;
  std::vector<double> theta;
  Chunk chunk;
  const auto shape = [&](std::size_t i, Vec3 normal, const WeightedNeighborhood& near) -> Ellipse {
    if (!along_ridges) return ellipse_of_positions(normal, chunk.eigen[i % Chunk::kPoints]);
    const Vec3 ridge = unit_or_zero(cross(normal, unit_or_zero(in.value<Float3>(1, i))));
    const double k1 = in.value<float>(2, i), k2 = in.value<float>(3, i);
    if (ridge != Vec3{} && k1 > 0 && k2 >= 0) return {normal, ridge, std::sqrt(k2 / k1)};
    return ellipse_of_positions(normal, eigen_symmetric3(near.moments(theta)));
  };
  const std::span<Float3> axis = out.column<Float3>(0);
  const std::span<float> length = out.column<float>(1), ratio = out.column<float>(2);
  for (std::size_t i = 0; i < in.size(); ++i) {
    if (!along_ridges && i % Chunk::kPoints == 0) chunk.gather(in, i, theta);
    axis[i] = {}, length[i] = 0, ratio[i] = 0;
    const WeightedNeighborhood near(in, i);
    const Vec3 normal = unit_or_zero(in.value<Float3>(0, i));
    if (near.size() > 0 && normal != Vec3{}) {
      const Ellipse ellipse = shape(i, normal, near);
      const double fitted = fitted_length(ellipse, near);
      if (fitted > 0) {
        axis[i] = stored_direction(ellipse.major);
        length[i] = saturated_float(fitted * near.unscale());
        ratio[i] = static_cast<float>(ellipse.ratio);
        continue;
      }
    }
    ++out.degenerate;
  }
}

}  // namespace pointsweep
