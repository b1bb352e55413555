// SPDX-License-Identifier: MIT
/// Directions of vectors, and unit tangents of planes, in vector lanes. Included once per instruction set.
#if defined(POINTSWEEP_OPERATORS_TANGENT_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTSWEEP_OPERATORS_TANGENT_LANES_INL_H_
#undef POINTSWEEP_OPERATORS_TANGENT_LANES_INL_H_
#else
#define POINTSWEEP_OPERATORS_TANGENT_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "pointsweep/math/eigen3_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {

/// The direction of a vector: `unit` is a unit vector if the direction exists, else 0.
template <class V>
struct Direction {
  Vec3Lanes<V> unit;
  hn::Mask<hn::DFromV<V>> exists;
};

/// Returns the direction of v, which exists unless |v|² is 0 or not finite in floating point. For vectors whose squared
/// length 1 + e is near 1, as that of stored unit vectors, 1 / |v| is 1 - e/2 + 3e²/8 to rounding.
template <class V>
HWY_INLINE Direction<V> DirectionOf(const Vec3Lanes<V>& v) {
  const hn::DFromV<V> d;
  const V one = hn::Set(d, 1.0), length2 = Dot(v, v);
  const V e = hn::Sub(length2, one);
  const auto near_unit = hn::Lt(hn::Abs(e), hn::Set(d, 0x1p-18));
  V inverse = hn::Sub(one, hn::Mul(e, hn::Sub(hn::Set(d, 0.5), hn::Mul(hn::Set(d, 0.375), e))));
  if (!hn::AllTrue(d, near_unit)) {
    const V size = hn::Sqrt(length2);
    const auto direction = hn::And(hn::Gt(size, hn::Zero(d)), hn::IsFinite(size));
    inverse = hn::IfThenElse(near_unit, inverse, hn::Div(one, size));
    return {{hn::IfThenElseZero(direction, hn::Mul(inverse, v.x)), hn::IfThenElseZero(direction, hn::Mul(inverse, v.y)),
             hn::IfThenElseZero(direction, hn::Mul(inverse, v.z))},
            direction};
  }
  return {Times(inverse, v), near_unit};
}
template <class V>
HWY_INLINE Vec3Lanes<V> UnitOrZero(const Vec3Lanes<V>& v) {
  return DirectionOf(v).unit;
}

/// Returns a unit tangent of the plane with unit normal n. `along` and `across` are orthogonal unit vectors; usually
/// neither is exactly tangent. If `along` is the nearer to the plane, or as near, the result is its direction in the
/// plane, else the tangent perpendicular to `across`. If n is 0, the result is `along`.
template <class V>
HWY_INLINE Vec3Lanes<V> Tangent(const Vec3Lanes<V>& n, const Vec3Lanes<V>& along, const Vec3Lanes<V>& across) {
  const V lift = Dot(n, along);
  const Vec3Lanes<V> flat = Minus(along, Times(lift, n));
  const auto nearer = hn::Le(hn::Abs(lift), hn::Abs(Dot(n, across)));
  return UnitOrZero(Choose(nearer, flat, Cross(across, n)));
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
