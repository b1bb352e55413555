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

/// No eigenvector feels the factors that are left out of the moments.
HWY_INLINE void StoreNormals(const Moments& moments, const Eigen3Lanes<V>& e, std::span<std::array<float, 3>> normals) {
  const Lanes d;
  const V noise = hn::Mul(moments.weights, hn::Mul(moments.weighting.rounding, moments.weighting.rounding));
  const auto plane = hn::Gt(e.value1, hn::Add(hn::Mul(hn::Set(d, 1e-12), e.value2), noise));
  LaneArray x, y, z;
  hn::Store(hn::IfThenElseZero(plane, e.vector0.x), d, x.of);
  hn::Store(hn::IfThenElseZero(plane, e.vector0.y), d, y.of);
  hn::Store(hn::IfThenElseZero(plane, e.vector0.z), d, z.of);
  for (std::size_t l = 0; l < std::min(kLanes, normals.size()); ++l)
    normals[l] = {float(x.of[l]), float(y.of[l]), float(z.of[l])};
}

void UnorientedNormals(const Neighborhoods& in, std::span<std::array<float, 3>> normals) {
  for (std::size_t first = 0; first < in.size();) {
    Tile tile(in, first, in.size());
    Offsets offsets(tile, {in});
    const Extents extents(tile, offsets);
    for (std::size_t v = 0; v < tile.vectors; v += 2) {
      const Moments a = SumMoments(tile, extents, offsets, v);
      const Moments b = v + 1 < tile.vectors ? SumMoments(tile, extents, offsets, v + 1) : a;
      const auto eigen = EigenSymmetric3(Lanes(), a.m, b.m);
      const auto rest = normals.subspan(first + v * kLanes, tile.size - v * kLanes);
      StoreNormals(a, eigen[0], rest);
      StoreNormals(b, eigen[1], rest.subspan(std::min(kLanes, rest.size())));
    }
    first += tile.size;
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
