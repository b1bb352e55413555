// SPDX-License-Identifier: MIT
/// symmetric3.h in vector lanes, one matrix per lane: the same operations in the same order as in symmetric3.h, hence
/// the same bits for any number of lanes. The code uses only Add, Sub, Mul, Div, Sqrt, comparisons and bit operations,
/// never a fused multiply-add. Included once per instruction set.
#if defined(POINTSWEEP_MATH_EIGEN3_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTSWEEP_MATH_EIGEN3_LANES_INL_H_
#undef POINTSWEEP_MATH_EIGEN3_LANES_INL_H_
#else
#define POINTSWEEP_MATH_EIGEN3_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <utility>

#include "pointsweep/math/symmetric3.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// One matrix per lane. Eigen3Lanes holds the results: ascending eigenvalues and their eigenvectors.
template <class V>
struct Symmetric3Lanes {
  V xx, xy, xz, yy, yz, zz;
};
template <class V>
struct Vec3Lanes {
  V x, y, z;
};
template <class V>
struct Eigen3Lanes {
  V value0, value1, value2;
  Vec3Lanes<V> vector0, vector1, vector2;
};

template <class D, class V = hn::Vec<D>>
HWY_INLINE V PowerOfTwoBelow(D d, V x) {
  const hn::RebindToUnsigned<D> du;
  return hn::BitCast(d, hn::And(hn::BitCast(du, x), hn::Set(du, std::uint64_t{0x7ff} << 52)));
}
template <class D, class V = hn::Vec<D>>
HWY_INLINE V ReciprocalOfPower(D d, V power) {
  const hn::RebindToUnsigned<D> du;
  return hn::BitCast(d, hn::Sub(hn::Set(du, std::uint64_t{2046} << 52), hn::BitCast(du, power)));
}

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
HWY_INLINE Vec3Lanes<V> Plus(const Vec3Lanes<V>& a, const Vec3Lanes<V>& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
template <class V>
HWY_INLINE Vec3Lanes<V> Minus(const Vec3Lanes<V>& a, const Vec3Lanes<V>& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
template <class V>
HWY_INLINE Vec3Lanes<V> Times(V s, const Vec3Lanes<V>& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
template <class V>
HWY_INLINE Vec3Lanes<V> Times(const Symmetric3Lanes<V>& m, const Vec3Lanes<V>& v) {
  return {Dot({m.xx, m.xy, m.xz}, v), Dot({m.xy, m.yy, m.yz}, v), Dot({m.xz, m.yz, m.zz}, v)};
}
template <class V, class M>
HWY_INLINE Vec3Lanes<V> Choose(M mask, const Vec3Lanes<V>& yes, const Vec3Lanes<V>& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}

/// First step of eigen_symmetric3(), one matrix per lane: the matrix, scaled by a power of two. Each step is a struct
/// whose constructor uses the results of earlier steps.
template <class D, class V = hn::Vec<D>>
struct ScaledLanes {
  Symmetric3Lanes<V> m;
  V size;

  HWY_INLINE ScaledLanes(D d, const Symmetric3Lanes<V>& a) {
    const V diagonal = hn::Max(hn::Max(hn::Abs(a.xx), hn::Abs(a.yy)), hn::Abs(a.zz));
    const V others = hn::Max(hn::Max(hn::Abs(a.xy), hn::Abs(a.xz)), hn::Abs(a.yz));
    size = PowerOfTwoBelow(d, hn::Max(diagonal, others));
    const V scale = ReciprocalOfPower(d, size);
    m = {hn::Mul(a.xx, scale), hn::Mul(a.xy, scale), hn::Mul(a.xz, scale),
         hn::Mul(a.yy, scale), hn::Mul(a.yz, scale), hn::Mul(a.zz, scale)};
  }
};

/// Second step: B = (A - mean) / spread of the scaled matrix A, and the well-separated root of the characteristic
/// polynomial of B.
template <class D, class V = hn::Vec<D>>
struct RootLanes {
  Symmetric3Lanes<V> b;
  V mean, spread, root;

  HWY_INLINE RootLanes(D d, const ScaledLanes<D>& scaled) {
    const Symmetric3Lanes<V>& m = scaled.m;
    mean = hn::Mul(hn::Add(hn::Add(m.xx, m.yy), m.zz), hn::Set(d, 1.0 / 3));
    const V dx = hn::Sub(m.xx, mean), dy = hn::Sub(m.yy, mean), dz = hn::Sub(m.zz, mean);
    const V diagonal2 = Dot<V>({dx, dy, dz}, {dx, dy, dz}), others2 = Dot<V>({m.xy, m.xz, m.yz}, {m.xy, m.xz, m.yz});
    const V spread2 = hn::Mul(hn::Add(diagonal2, hn::Add(others2, others2)), hn::Set(d, 1.0 / 6));
    spread = hn::Add(hn::Sqrt(spread2), hn::Set(d, deflation::kFloor));
    const V inverse = hn::Div(hn::Set(d, 1.0), spread);
    b = {hn::Mul(dx, inverse), hn::Mul(m.xy, inverse), hn::Mul(m.xz, inverse),
         hn::Mul(dy, inverse), hn::Mul(m.yz, inverse), hn::Mul(dz, inverse)};
    const V xx = hn::Sub(hn::Mul(b.yy, b.zz), hn::Mul(b.yz, b.yz));
    const V xy = hn::Sub(hn::Mul(b.xy, b.zz), hn::Mul(b.yz, b.xz));
    const V xz = hn::Sub(hn::Mul(b.xy, b.yz), hn::Mul(b.yy, b.xz));
    const V determinant = hn::Add(hn::Sub(hn::Mul(b.xx, xx), hn::Mul(b.xy, xy)), hn::Mul(b.xz, xz));
    const V r = hn::Min(hn::Mul(hn::Set(d, 0.5), hn::Abs(determinant)), hn::Set(d, 1.0));
    root = hn::CopySign(LargestRoot(d, r), determinant);
  }

  static HWY_INLINE V LargestRoot(D d, V r) {
    const auto constant = [&](int i) HWY_ATTR { return hn::Set(d, deflation::kRoot[i]); };
    V b = constant(5);
    for (int i = 4; i >= 0; --i) b = hn::Add(constant(i), hn::Mul(r, b));
    const V f = hn::Sub(hn::Mul(b, hn::Sub(hn::Mul(b, b), hn::Set(d, 3.0))), hn::Add(r, r));
    const V slope = hn::Mul(hn::Set(d, 3.0), hn::Sub(hn::Mul(b, b), hn::Set(d, 1.0)));
    const V twice = hn::Add(slope, slope);
    const V bend = hn::Mul(hn::Mul(hn::Set(d, 6.0), b), f);
    return hn::Sub(b, hn::Div(hn::Mul(hn::Add(f, f), slope), hn::Sub(hn::Mul(twice, slope), bend)));
  }
};

/// Third step: the eigenvector of the well-separated root, and an orthonormal basis of the plane perpendicular to this
/// eigenvector.
template <class D, class V = hn::Vec<D>>
struct BasisLanes {
  Vec3Lanes<V> v, p, q;

  HWY_INLINE BasisLanes(D d, const RootLanes<D>& r) {
    const V one = hn::Set(d, 1.0);
    const V x = hn::Sub(r.b.xx, r.root), y = hn::Sub(r.b.yy, r.root), z = hn::Sub(r.b.zz, r.root);
    const V xy = r.b.xy, xz = r.b.xz, yz = r.b.yz;
    const V axx = hn::Sub(hn::Mul(y, z), hn::Mul(yz, yz)), ayy = hn::Sub(hn::Mul(x, z), hn::Mul(xz, xz));
    const V azz = hn::Sub(hn::Mul(x, y), hn::Mul(xy, xy)), axy = hn::Sub(hn::Mul(xz, yz), hn::Mul(xy, z));
    const V axz = hn::Sub(hn::Mul(xy, yz), hn::Mul(xz, y)), ayz = hn::Sub(hn::Mul(xy, xz), hn::Mul(x, yz));
    const V first = hn::Abs(axx), second = hn::Abs(ayy);
    const auto take_second = hn::Gt(second, first);
    const V pivot = hn::IfThenElse(take_second, second, first);
    Vec3Lanes<V> column = Choose(take_second, Vec3Lanes<V>{axy, ayy, ayz}, Vec3Lanes<V>{axx, axy, axz});
    column = Choose(hn::Gt(hn::Abs(azz), pivot), Vec3Lanes<V>{axz, ayz, azz}, column);
    v = Times(hn::Div(one, hn::Sqrt(Dot(column, column))), column);

    const V zero = hn::Zero(d), vx = hn::Abs(v.x), vy = hn::Abs(v.y), vz = hn::Abs(v.z);
    const auto least_x = hn::And(hn::Le(vx, vy), hn::Le(vx, vz)), least_y = hn::Le(vy, vz);
    const Vec3Lanes<V> of_others =
        Choose(least_y, Vec3Lanes<V>{hn::Neg(v.z), zero, v.x}, Vec3Lanes<V>{v.y, hn::Neg(v.x), zero});
    const Vec3Lanes<V> across = Choose(least_x, Vec3Lanes<V>{zero, v.z, hn::Neg(v.y)}, of_others);
    p = Times(hn::Div(one, hn::Sqrt(Dot(across, across))), across);
    q = Cross(v, p);
  }
};

/// Fourth step: the 2×2 eigenvalue problem in the plane of BasisLanes, which is perpendicular to the eigenvector found
/// first.
template <class D, class V = hn::Vec<D>>
struct PairLanes {
  V value_less, value_greater;
  Vec3Lanes<V> less, greater;

  HWY_INLINE PairLanes(D d, const ScaledLanes<D>& scaled, const BasisLanes<D>& basis) {
    const Vec3Lanes<V>&p = basis.p, &q = basis.q;
    const V half_of = hn::Set(d, 0.5);
    const Vec3Lanes<V> ap = Times(scaled.m, p), aq = Times(scaled.m, q);
    const V pp = Dot(p, ap), qq = Dot(q, aq), pq = Dot(p, aq);
    const V half = hn::Mul(half_of, hn::Sub(pp, qq)), middle = hn::Mul(half_of, hn::Add(pp, qq));
    const V along = hn::Add(hn::Abs(half), hn::Set(d, deflation::kFloor));
    const V radius = hn::Sqrt(hn::Add(hn::Mul(along, along), hn::Mul(pq, pq)));
    const V both = hn::Add(radius, along);
    const V shortest = hn::Div(hn::Set(d, 1.0), hn::Sqrt(hn::Add(hn::Mul(both, both), hn::Mul(pq, pq))));
    const V c = hn::Mul(both, shortest), s = hn::Mul(pq, shortest);
    const auto first = hn::Ge(half, hn::Zero(d));
    greater = InPlane(p, q, hn::IfThenElse(first, c, s), hn::IfThenElse(first, s, c));
    less = InPlane(p, q, hn::IfThenElse(first, hn::Neg(s), c), hn::IfThenElse(first, c, hn::Neg(s)));
    const V apart = hn::Sub(radius, hn::Set(d, deflation::kFloor));
    value_greater = hn::Mul(hn::Add(middle, apart), scaled.size);
    value_less = hn::Mul(hn::Sub(middle, apart), scaled.size);
  }

  static HWY_INLINE Vec3Lanes<V> InPlane(const Vec3Lanes<V>& p, const Vec3Lanes<V>& q, V a, V b) {
    return {hn::Add(hn::Mul(a, p.x), hn::Mul(b, q.x)), hn::Add(hn::Mul(a, p.y), hn::Mul(b, q.y)),
            hn::Add(hn::Mul(a, p.z), hn::Mul(b, q.z))};
  }
};

template <class D, class V = hn::Vec<D>>
HWY_INLINE Eigen3Lanes<V> Ascending(D d, const ScaledLanes<D>& scaled, const RootLanes<D>& r,
                                    const BasisLanes<D>& basis, const PairLanes<D>& pair) {
  const auto largest = hn::Ge(r.root, hn::Zero(d));
  const V as_root = hn::Mul(hn::Add(r.mean, hn::Mul(r.spread, r.root)), scaled.size);
  const V as_quotient = hn::Mul(Dot(basis.v, Times(scaled.m, basis.v)), scaled.size);
  const V last = hn::IfThenElse(hn::Lt(as_root, pair.value_greater), pair.value_greater, as_root);
  const V first = hn::IfThenElse(hn::Lt(pair.value_less, as_quotient), pair.value_less, as_quotient);
  return {
      hn::IfThenElse(largest, pair.value_less, first),   hn::IfThenElse(largest, pair.value_greater, pair.value_less),
      hn::IfThenElse(largest, last, pair.value_greater), Choose(largest, pair.less, basis.v),
      Choose(largest, pair.greater, pair.less),          Choose(largest, basis.v, pair.greater)};
}

template <class D, std::size_t N, std::size_t... I, class V = hn::Vec<D>>
HWY_INLINE std::array<Eigen3Lanes<V>, N> SolveTogether(D d, const ScaledLanes<D> (&scaled)[N],
                                                       std::index_sequence<I...>) {
  const RootLanes<D> roots[N] = {RootLanes<D>(d, scaled[I])...};
  const BasisLanes<D> bases[N] = {BasisLanes<D>(d, roots[I])...};
  const PairLanes<D> pairs[N] = {PairLanes<D>(d, scaled[I], bases[I])...};
  return {Ascending(d, scaled[I], roots[I], bases[I], pairs[I])...};
}

/// Returns the eigenvalues and eigenvectors of several vectors of matrices, with the bits of eigen_symmetric3(). One
/// vector of matrices needs a long chain of dependent operations; several independent chains use the processor better.
template <class D, class V = hn::Vec<D>, class... More>
HWY_INLINE std::array<Eigen3Lanes<V>, sizeof...(More)> EigenSymmetric3(D d, const More&... m) {
  const ScaledLanes<D> scaled[] = {ScaledLanes<D>(d, m)...};
  return SolveTogether(d, scaled, std::make_index_sequence<sizeof...(More)>());
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
