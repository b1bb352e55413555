// SPDX-License-Identifier: MIT
#include <cstddef>

#include "pointsweep/math/instruction_sets.h"
#include "pointsweep/operators/surface/normals.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pointsweep/operators/surface/normals_kernel.cpp"
#include <hwy/foreach_target.h>
// The lanes must be included after foreach_target.h, which includes this file for each instruction set.
#include "pointsweep/operators/lanes/column_lanes-inl.h"
#include "pointsweep/operators/lanes/neighborhood_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {

/// Stores normals, and marks points without a normal as degenerate. The moments of a point are M_i times a positive
/// factor, which does not change eigenvectors.
HWY_INLINE void StoreNormals(const Moments& moments, const Eigen3Lanes<V>& e, const Points& points,
                             std::span<std::array<float, 3>> normals, DegeneratePoints& degenerate) {
  const Lanes d;
  const V noise = hn::Mul(moments.weights, hn::Mul(moments.scaling.rounding, moments.scaling.rounding));
  const auto plane = hn::Gt(e.value1, hn::Add(hn::Mul(hn::Set(d, 1e-12), e.value2), noise));
  StoreDirections(plane, e.vector0, points, normals);
  points.MarkWithout(plane, degenerate);
}

void UnorientedNormals(const Neighborhoods& in, std::span<std::array<float, 3>> normals, DegeneratePoints& degenerate) {
  for (std::size_t first = 0; first < in.size();) {
    Tile tile(in, first, in.size());
    Offsets offsets(tile, {in});
    const Extents extents(tile, offsets);
    Weights weights(tile, extents, offsets);
    for (std::size_t v = 0; v < tile.vectors; v += 2) {
      const Moments a = SumMoments(tile, extents, offsets, weights, v);
      const Moments b = v + 1 < tile.vectors ? SumMoments(tile, extents, offsets, weights, v + 1) : a;
      const auto eigen = EigenSymmetric3(Lanes(), a.m, b.m);
      StoreNormals(a, eigen[0], Points(tile, v), normals, degenerate);
      StoreNormals(b, eigen[1], Points(tile, v + 1), normals, degenerate);  // the second vector may have no points
    }
    first += tile.size;
  }
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointsweep {

HWY_EXPORT(UnorientedNormals);

void unoriented_normals(const Neighborhoods& in, std::span<std::array<float, 3>> normals,
                        DegeneratePoints& degenerate) {
  HWY_DYNAMIC_DISPATCH(UnorientedNormals)(in, normals, degenerate);
}

}  // namespace pointsweep
#endif
