// SPDX-License-Identifier: MIT
/// Directions in and across tangent planes, in vector lanes. Included once per instruction set.
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

template <class V>
HWY_INLINE V Dot(const Vec3Lanes<V>& a, const Vec3Lanes<V>& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
template <class V>
HWY_INLINE Vec3Lanes<V> Cross(const Vec3Lanes<V>& a, const Vec3Lanes<V>& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
template <class V>
HWY_INLINE Vec3Lanes<V> Times(V s, const Vec3Lanes<V>& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
template <class V, class M>
HWY_INLINE Vec3Lanes<V> Choose(M mask, const Vec3Lanes<V>& yes, const Vec3Lanes<V>& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}

/// v / |v|, or 0 where v is 0 or not finite.
template <class V>
HWY_INLINE Vec3Lanes<V> UnitOrZero(const Vec3Lanes<V>& v) {
  const hn::DFromV<V> d;
  const V size = hn::Sqrt(Dot(v, v));
  const auto direction = hn::And(hn::Gt(size, hn::Zero(d)), hn::IsFinite(size));
  const V inverse = hn::Div(hn::Set(d, 1.0), size);
  return {hn::IfThenElseZero(direction, hn::Mul(inverse, v.x)), hn::IfThenElseZero(direction, hn::Mul(inverse, v.y)),
          hn::IfThenElseZero(direction, hn::Mul(inverse, v.z))};
}

/// The unit tangent of the plane with unit normal n that goes along `along` and across `across`. These two are unit and
/// orthogonal; seldom is either exactly tangent. The one nearer to the plane decides, so it never fails.
template <class V>
HWY_INLINE Vec3Lanes<V> Tangent(const Vec3Lanes<V>& n, const Vec3Lanes<V>& along, const Vec3Lanes<V>& across) {
  const V lift = Dot(n, along);
  const Vec3Lanes<V> flat = {hn::Sub(along.x, hn::Mul(lift, n.x)), hn::Sub(along.y, hn::Mul(lift, n.y)),
                             hn::Sub(along.z, hn::Mul(lift, n.z))};
  const auto nearer = hn::Le(hn::Abs(lift), hn::Abs(Dot(n, across)));
  return UnitOrZero(Choose(nearer, flat, Cross(across, n)));
}

/// u^T m v
template <class V>
HWY_INLINE V BilinearForm(const Symmetric3Lanes<V>& m, const Vec3Lanes<V>& u, const Vec3Lanes<V>& v) {
  return Dot(u, Vec3Lanes<V>{Dot({m.xx, m.xy, m.xz}, v), Dot({m.xy, m.yy, m.yz}, v), Dot({m.xz, m.yz, m.zz}, v)});
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
