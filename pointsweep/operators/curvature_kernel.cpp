// SPDX-License-Identifier: MIT
#include "pointsweep/operators/curvature_kernel.h"

#include <algorithm>

#include "pointsweep/math/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pointsweep/operators/curvature_kernel.cpp"
#include <hwy/foreach_target.h>
// The lanes follow the inclusion of the targets.
#include "pointsweep/operators/neighborhood_lanes-inl.h"
#include "pointsweep/operators/tangent_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {

using Vector = Vec3Lanes<V>;
using Matrix = Symmetric3Lanes<V>;

/// Sums over the neighbours that have a normal; over all of them in `moments`.
struct Sums {
  Weighting weighting;
  Matrix moments = ZeroMatrix();           // |N_i| M_i of Equation 1
  Matrix weighted_normals = ZeroMatrix();  // |N_i| C_i of Equation 2
  Matrix normals = ZeroMatrix(), positions = ZeroMatrix();
  Vector position{hn::Zero(Lanes()), hn::Zero(Lanes()), hn::Zero(Lanes())};
  V count = hn::Zero(Lanes());

  HWY_INLINE void Include(const Vector& raw, const Vector& direction, std::size_t j) {
    const Lanes d;
    const Vector offset = weighting.Scaled(raw), n = UnitOrZero(direction);
    const V theta = weighting.Theta(offset, j);
    AddOuterProduct(moments, theta, offset);
    AddOuterProduct(weighted_normals, theta, n);
    AddOuterProduct(normals, n);
    const auto has_normal = hn::Gt(Dot(n, n), hn::Zero(d));
    const Vector seen{hn::IfThenElseZero(has_normal, offset.x), hn::IfThenElseZero(has_normal, offset.y),
                      hn::IfThenElseZero(has_normal, offset.z)};
    AddOuterProduct(positions, seen);
    position = {hn::Add(position.x, seen.x), hn::Add(position.y, seen.y), hn::Add(position.z, seen.z)};
    count = hn::Add(count, hn::IfThenElseZero(has_normal, hn::Set(d, 1.0)));
  }

  /// Of the positions along unit vectors, about their mean, times `count`.
  HWY_INLINE V Covariance(const Vector& u, const Vector& v) const {
    return hn::Sub(BilinearForm(positions, u, v), hn::Div(hn::Mul(Dot(position, u), Dot(position, v)), count));
  }
};

/// Curvatures of a point per lane; `found` where there are any.
struct Principal {
  V k1, k2;
  Vector direction;
  hn::Mask<Lanes> found;
};

/// `e` is that of sums.normals.
HWY_INLINE Principal PrincipalCurvatures(const Vector& n, const Sums& sums, const Eigen3Lanes<V>& e) {
  const Lanes d;
  const V zero = hn::Zero(d);
  const Vector along = Tangent(n, e.vector1, e.vector0), across = Cross(n, along);
  const V p1 = sums.Covariance(along, along), p2 = sums.Covariance(across, across);
  const V p12 = sums.Covariance(along, across);
  const V rounding = sums.weighting.rounding;
  const V spread = hn::Add(p1, p2), noise = hn::Mul(sums.count, hn::Mul(rounding, rounding));
  // The determinant over the trace is the smaller eigenvalue, to a factor of two: 0 for points on a line.
  const V determinant = hn::Sub(hn::Mul(p1, p2), hn::Mul(p12, p12));
  const V least = hn::Mul(hn::Add(hn::Mul(hn::Set(d, 1e-12), spread), noise), spread);
  const auto found =
      hn::And(hn::And(hn::Gt(Dot(n, n), zero), hn::Ge(sums.count, hn::Set(d, 3.0))), hn::Gt(determinant, least));
  const V a = hn::Sqrt(hn::Div(hn::Max(e.value1, zero), p1)), b = hn::Sqrt(hn::Div(hn::Max(e.value0, zero), p2));
  return {hn::Max(a, b), hn::Min(a, b), Choose(hn::Lt(a, b), across, along), found};
}

/// Inline, so that eigenvectors nobody looks at are not computed.
HWY_INLINE void StoreCurvatures(const Principal& p, const Sums& sums, const Eigen3Lanes<V>& moments,
                                const Eigen3Lanes<V>& weighted_normals, std::span<PointCurvature> out) {
  const Lanes d;
  const V zero = hn::Zero(d), most = hn::Set(d, 1e150);  // so that a product is a number; a float holds far less
  const V sum = hn::Add(hn::Add(moments.value0, moments.value1), moments.value2);
  const V variation = hn::IfThenElseZero(hn::Gt(sum, zero), hn::Div(hn::Max(moments.value0, zero), sum));
  const V share = hn::Div(sums.weighting.NearestTheta(), hn::Max(sums.weighting.count, hn::Set(d, 1.0)));
  const auto eigenvalue = [&](V v) HWY_ATTR { return hn::Mul(hn::Max(v, zero), share); };
  const V values[9] = {hn::Min(hn::Mul(p.k1, sums.weighting.scale), most),
                       hn::Min(hn::Mul(p.k2, sums.weighting.scale), most),
                       p.direction.x,
                       p.direction.y,
                       p.direction.z,
                       variation,
                       eigenvalue(weighted_normals.value0),
                       eigenvalue(weighted_normals.value1),
                       eigenvalue(weighted_normals.value2)};
  LaneArray lanes[9];
  for (std::size_t i = 0; i < 9; ++i) hn::Store(hn::IfThenElseZero(p.found, values[i]), d, lanes[i].of);
  for (std::size_t l = 0; l < std::min(kLanes, out.size()); ++l)
    out[l] = {lanes[0].of[l],
              lanes[1].of[l],
              {lanes[2].of[l], lanes[3].of[l], lanes[4].of[l]},
              lanes[5].of[l],
              {lanes[6].of[l], lanes[7].of[l], lanes[8].of[l]}};
}

struct NormalOf {
  const Neighborhoods& in;
  HWY_INLINE auto operator()(std::size_t) const {
    return [this](NeighborRef ref) HWY_ATTR { return in.vector_of(0, ref); };
  }
};

void Curvatures(const Neighborhoods& in, std::size_t first, std::span<PointCurvature> out) {
  for (std::size_t done = 0; done < out.size();) {
    Tile tile(in, first + done, first + out.size());
    Offsets offsets(tile, {in});
    const Extents extents(tile, offsets);
    NeighborVectors<NormalOf> directions(tile, {in});
    const OwnVectors own(tile, 0);
    for (std::size_t v = 0; v < tile.vectors; ++v) {
      Sums sums{Weighting(extents, v)};
      for (std::size_t from = 0; from < tile.most; from += tile.chunk) {
        offsets.Hold(from);
        directions.Hold(from);
        for (std::size_t c = 0; c < std::min(tile.chunk, tile.most - from); ++c)
          sums.Include(offsets.Load(v, c), directions.Load(v, c), from + c);
      }
      const auto e = EigenSymmetric3(Lanes(), sums.normals, sums.weighted_normals, sums.moments);
      const Principal p = PrincipalCurvatures(UnitOrZero(own.Load(v)), sums, e[0]);
      StoreCurvatures(p, sums, e[2], e[1], out.subspan(done + v * kLanes, std::min(kLanes, tile.size - v * kLanes)));
    }
    done += tile.size;
  }
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointsweep {

HWY_EXPORT(Curvatures);

void curvatures(const Neighborhoods& in, std::size_t first, std::span<PointCurvature> out) {
  HWY_DYNAMIC_DISPATCH(Curvatures)(in, first, out);
}

}  // namespace pointsweep
#endif
