// SPDX-License-Identifier: MIT
/// symmetric3.h in vector lanes, one matrix per lane: the same operations in the same order, hence the same bits for
/// any number of lanes. Only Add, Sub, Mul, Div and bit operations; never a fused multiply-add. Included once per
/// instruction set.
#if defined(POINTSWEEP_MATH_EIGEN3_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTSWEEP_MATH_EIGEN3_LANES_INL_H_
#undef POINTSWEEP_MATH_EIGEN3_LANES_INL_H_
#else
#define POINTSWEEP_MATH_EIGEN3_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <array>

#include "pointsweep/math/symmetric3.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// In: a matrix per lane. Out: ascending values, and their vectors.
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
HWY_INLINE void Turn(V& a, V& b, V d, V n) {
  const V turned = hn::Add(hn::Mul(a, d), hn::Mul(b, n));
  b = hn::Sub(hn::Mul(b, d), hn::Mul(a, n));
  a = turned;
}

/// As jacobi::rotate.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void Rotate(D tag, V& app, V& aqq, V& apq, V& arp, V& arq, V& q0, V& q1, V& q2, V& q3) {
  using namespace jacobi;
  const V difference = hn::Sub(aqq, app);
  const V twice = hn::Add(apq, apq);
  const V d_raw = hn::Add(hn::Abs(difference), hn::Set(tag, kFloor));
  const V e_raw = hn::Abs(twice);
  const V scale = ReciprocalOfPower(tag, PowerOfTwoBelow(tag, hn::Add(d_raw, e_raw)));
  const V d = hn::Mul(d_raw, scale), e = hn::Mul(e_raw, scale);
  const V e2 = hn::Mul(e, e);
  const V h = hn::Mul(d, hn::Add(d, hn::Mul(hn::Set(tag, kB), e)));
  const V e_signed = hn::CopySignToAbs(e, hn::Xor(difference, twice));
  const V n_half = hn::Mul(e_signed, hn::Add(h, hn::Mul(hn::Set(tag, kC), e2)));
  const V d_half = hn::Add(hn::Mul(hn::Mul(hn::Set(tag, 4.0), d), hn::Add(h, hn::Mul(hn::Set(tag, kC + 0.3125), e2))),
                           hn::Mul(hn::Mul(hn::Set(tag, kF), e), e2));

  const V dd = hn::Mul(d_half, d_half), nn = hn::Mul(n_half, n_half);
  const V inverse = hn::Div(hn::Set(tag, 1.0), hn::Add(dd, nn));
  const V c = hn::Mul(hn::Sub(dd, nn), inverse);
  const V dn = hn::Mul(d_half, n_half);
  const V s = hn::Mul(hn::Add(dn, dn), inverse);

  const V half = hn::Mul(hn::Set(tag, 0.5), difference);
  const V w = hn::Sub(hn::Mul(c, apq), hn::Mul(s, half));
  const V change = hn::Mul(hn::Add(s, s), w);
  apq = hn::Sub(hn::Mul(c, w), hn::Mul(s, hn::Add(hn::Mul(s, apq), hn::Mul(c, half))));
  app = hn::Sub(app, change);
  aqq = hn::Add(aqq, change);
  const V turned = hn::Sub(hn::Mul(c, arp), hn::Mul(s, arq));
  arq = hn::Add(hn::Mul(s, arp), hn::Mul(c, arq));
  arp = turned;
  Turn(q0, q1, d_half, n_half);
  Turn(q2, q3, d_half, n_half);
}

/// Brings the pair (value, vector) with the smaller value first.
template <class V>
HWY_INLINE void Ascend(V& value0, V& value1, Vec3Lanes<V>& a, Vec3Lanes<V>& b) {
  const auto swap = hn::Lt(value1, value0);
  const auto exchange = [&](V& p, V& q) HWY_ATTR {
    const V first = hn::IfThenElse(swap, q, p);
    q = hn::IfThenElse(swap, p, q);
    p = first;
  };
  exchange(value0, value1);
  exchange(a.x, b.x);
  exchange(a.y, b.y);
  exchange(a.z, b.z);
}

/// The iteration of one matrix per lane: the matrix, scaled, and the quaternion (w, x, y, z) of the rotation so far.
template <class V>
struct JacobiLanes {
  V xx, xy, xz, yy, yz, zz, w, x, y, z, size;
};

template <class D, class V = hn::Vec<D>>
HWY_INLINE JacobiLanes<V> Begin(D d, const Symmetric3Lanes<V>& m) {
  const V diagonal = hn::Max(hn::Max(hn::Abs(m.xx), hn::Abs(m.yy)), hn::Abs(m.zz));
  const V others = hn::Max(hn::Max(hn::Abs(m.xy), hn::Abs(m.xz)), hn::Abs(m.yz));
  const V size = PowerOfTwoBelow(d, hn::Max(diagonal, others));
  const V scale = ReciprocalOfPower(d, size);
  const V zero = hn::Zero(d);
  return {hn::Mul(m.xx, scale),
          hn::Mul(m.xy, scale),
          hn::Mul(m.xz, scale),
          hn::Mul(m.yy, scale),
          hn::Mul(m.yz, scale),
          hn::Mul(m.zz, scale),
          hn::Set(d, 1.0),
          zero,
          zero,
          zero,
          size};
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE Eigen3Lanes<V> End(D d, const JacobiLanes<V>& j) {
  const V w = j.w, x = j.x, y = j.y, z = j.z, one = hn::Set(d, 1.0);
  const V norm2 = hn::Add(hn::Add(hn::Mul(w, w), hn::Mul(x, x)), hn::Add(hn::Mul(y, y), hn::Mul(z, z)));
  const V t = hn::Div(hn::Set(d, 2.0), norm2);
  const V tx = hn::Mul(t, x), ty = hn::Mul(t, y), tz = hn::Mul(t, z);
  const V xx = hn::Mul(tx, x), yy = hn::Mul(ty, y), zz = hn::Mul(tz, z);
  const V xy = hn::Mul(tx, y), xz = hn::Mul(tx, z), yz = hn::Mul(ty, z);
  const V wx = hn::Mul(tx, w), wy = hn::Mul(ty, w), wz = hn::Mul(tz, w);
  Eigen3Lanes<V> out{hn::Mul(j.xx, j.size),
                     hn::Mul(j.yy, j.size),
                     hn::Mul(j.zz, j.size),
                     {hn::Sub(one, hn::Add(yy, zz)), hn::Add(xy, wz), hn::Sub(xz, wy)},
                     {hn::Sub(xy, wz), hn::Sub(one, hn::Add(xx, zz)), hn::Add(yz, wx)},
                     {hn::Add(xz, wy), hn::Sub(yz, wx), hn::Sub(one, hn::Add(xx, yy))}};
  Ascend(out.value0, out.value1, out.vector0, out.vector1);
  Ascend(out.value0, out.value2, out.vector0, out.vector2);
  Ascend(out.value1, out.value2, out.vector1, out.vector2);
  return out;
}

/// As eigen_symmetric3, for several vectors of matrices at once: a rotation is one long chain of dependent operations,
/// and only chains that do not depend on each other fill the machine.
template <class D, class V = hn::Vec<D>, class... More>
HWY_INLINE std::array<Eigen3Lanes<V>, sizeof...(More)> EigenSymmetric3(D d, const More&... m) {
  const auto solve = [d](auto... j) HWY_ATTR -> std::array<Eigen3Lanes<V>, sizeof...(More)> {
    for (int sweep = 0; sweep < jacobi::kSweeps; ++sweep) {
      (Rotate(d, j.xx, j.yy, j.xy, j.xz, j.yz, j.w, j.z, j.y, j.x), ...);
      (Rotate(d, j.xx, j.zz, j.xz, j.xy, j.yz, j.y, j.w, j.z, j.x), ...);
      (Rotate(d, j.yy, j.zz, j.yz, j.xy, j.xz, j.w, j.x, j.z, j.y), ...);
    }
    return {End(d, j)...};
  };
  return solve(Begin(d, m)...);
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
