// SPDX-License-Identifier: MIT
#include "pointsweep/operators/normals_kernel.h"

#include <algorithm>
#include <cstddef>

#include "pointsweep/math/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pointsweep/operators/normals_kernel.cpp"
#include <hwy/foreach_target.h>
// The lanes follow the inclusion of the targets.
#include "pointsweep/operators/neighborhood_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {

/// Σ_j o o^T θ of Equation 1, and what λ1 must exceed besides its share of λ2.
struct Moments {
  Symmetric3Lanes<V> m;
  V noise;
};

/// The factors that Weighting takes out no eigenvector feels; 1/|N_i| is left out likewise.
HWY_INLINE Moments SumMoments(const Neighborhoods& in, std::size_t first) {
  const Lanes d;
  const Extents extents(in, first);
  const Weighting weighting(extents);
  Symmetric3Lanes<V> m = ZeroMatrix();
  V weights = hn::Zero(d);
  ForNeighbors(in, first, extents, weighting.scale, [&](const Vec3Lanes<V>& offset, std::size_t j) HWY_ATTR {
    const V theta = weighting.Theta(offset, j);
    AddOuterProduct(m, theta, offset);
    weights = hn::Add(weights, theta);
  });
  const V rounding = weighting.Rounding(extents);
  return {m, hn::Mul(weights, hn::Mul(rounding, rounding))};
}

HWY_INLINE void StoreNormals(const Moments& moments, const Eigen3Lanes<V>& e, std::span<std::array<float, 3>> normals,
                             std::size_t first) {
  const Lanes d;
  const auto plane = hn::Gt(e.value1, hn::Add(hn::Mul(hn::Set(d, 1e-12), e.value2), moments.noise));
  LaneArray x, y, z;
  hn::Store(hn::IfThenElseZero(plane, e.vector0.x), d, x.of);
  hn::Store(hn::IfThenElseZero(plane, e.vector0.y), d, y.of);
  hn::Store(hn::IfThenElseZero(plane, e.vector0.z), d, z.of);
  for (std::size_t l = 0; l < kLanes && first + l < normals.size(); ++l)
    normals[first + l] = {float(x.of[l]), float(y.of[l]), float(z.of[l])};
}

void UnorientedNormals(const Neighborhoods& in, std::span<std::array<float, 3>> normals) {
  for (std::size_t first = 0; first < in.size(); first += 2 * kLanes) {
    const Moments a = SumMoments(in, first), b = SumMoments(in, first + kLanes);
    const auto eigen = EigenSymmetric3(Lanes(), a.m, b.m);
    StoreNormals(a, eigen[0], normals, first);
    StoreNormals(b, eigen[1], normals, first + kLanes);
  }
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointsweep {

HWY_EXPORT(UnorientedNormals);

void unoriented_normals(const Neighborhoods& in, std::span<std::array<float, 3>> normals) {
  HWY_DYNAMIC_DISPATCH(UnorientedNormals)(in, normals);
}

}  // namespace pointsweep
#endif
