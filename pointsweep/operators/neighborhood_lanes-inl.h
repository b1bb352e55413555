// SPDX-License-Identifier: MIT
/// Neighbourhoods in vector lanes, a point per lane: what Equations 1 and 2 need before and during their sums. Included
/// once per instruction set.
#if defined(POINTSWEEP_OPERATORS_NEIGHBORHOOD_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTSWEEP_OPERATORS_NEIGHBORHOOD_LANES_INL_H_
#undef POINTSWEEP_OPERATORS_NEIGHBORHOOD_LANES_INL_H_
#else
#define POINTSWEEP_OPERATORS_NEIGHBORHOOD_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "pointsweep/math/eigen3_lanes-inl.h"
#include "pointsweep/math/exp_lanes-inl.h"
#include "pointsweep/points/neighborhoods.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {

using Lanes = hn::ScalableTag<double>;
using V = hn::Vec<Lanes>;
constexpr std::size_t kLanes = hn::MaxLanes(Lanes());
constexpr std::size_t kChunk = 8;  // neighbours per lane that are fetched at a time

/// One number per lane.
struct LaneArray {
  HWY_ALIGN double of[kLanes];
  V Load() const { return hn::Load(Lanes(), of); }
};

/// What must be known of a neighbourhood before its sum begins. Neighbours come nearest first, so the last is the
/// farthest.
struct Extents {
  LaneArray count;    // |N_i|, 0 where every neighbour lies on p_i or one is too far away
  LaneArray largest;  // largest magnitude among the components of the last offset
  LaneArray far[3];   // the last offset
  LaneArray near[3];  // the first offset that is not 0
  LaneArray place;    // largest magnitude among the coordinates of p_i
  std::size_t most = 0;

  Extents(const Neighborhoods& in, std::size_t first) {
    for (std::size_t l = 0; l < kLanes; ++l) Measure(in, first + l, l);
  }

  void Measure(const Neighborhoods& in, std::size_t i, std::size_t l) {
    std::size_t k = i < in.size() ? in.count(i) : 0;
    Vec3 last{1, 0, 0}, nearest = last, p;
    double extent = 1;
    if (k > 0) {
      p = in.position(i);
      last = in.offset(i, k - 1);
      extent = std::max({std::abs(last.x), std::abs(last.y), std::abs(last.z)});
      std::size_t j = 0;
      while (j + 1 < k && in.offset(i, j) == Vec3{}) ++j;
      nearest = in.offset(i, j);
    }
    // Power-of-two scaling needs a normal number with a normal reciprocal.
    if (k == 0 || !(extent >= std::numeric_limits<double>::min() && extent < 0x1p1022)) {
      k = 0, extent = 1;
      last = nearest = {1, 0, 0};
    }
    most = std::max(most, k);
    count.of[l] = double(k);
    largest.of[l] = extent;
    for (int axis = 0; axis < 3; ++axis) far[axis].of[l] = last[axis], near[axis].of[l] = nearest[axis];
    place.of[l] = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
};

/// Vectors of a few successive neighbours, transposed: a point per lane, 0 behind a point's last neighbour.
struct NeighborChunk {
  HWY_ALIGN double x[kChunk][kLanes], y[kChunk][kLanes], z[kChunk][kLanes];

  /// of(l)(j): of the j-th neighbour of the point in lane l.
  template <class Of>
  HWY_INLINE void Fetch(const Extents& extents, std::size_t from, Of of) {
    for (std::size_t l = 0; l < kLanes; ++l) {
      const std::size_t k = std::size_t(extents.count.of[l]);
      const std::size_t have = std::min(kChunk, k - std::min(from, k));
      const auto vector = of(l);
      for (std::size_t c = 0; c < have; ++c) {
        const Vec3 v = vector(from + c);
        x[c][l] = v.x, y[c][l] = v.y, z[c][l] = v.z;
      }
      for (std::size_t c = have; c < kChunk; ++c) x[c][l] = y[c][l] = z[c][l] = 0;
    }
  }
  HWY_INLINE void FetchOffsets(const Neighborhoods& in, std::size_t first, const Extents& extents, std::size_t from) {
    Fetch(extents, from, [&](std::size_t l) HWY_ATTR {
      const std::size_t i = std::min(first + l, in.size() - 1);
      return [&in, p = in.position(i), refs = in.neighbors(i)](std::size_t j)
                 HWY_ATTR { return in.position_of(refs[j]) - p; };
    });
  }
  HWY_INLINE Vec3Lanes<V> Load(std::size_t c) const {
    const Lanes d;
    return {hn::Load(d, x[c]), hn::Load(d, y[c]), hn::Load(d, z[c])};
  }
  HWY_INLINE Vec3Lanes<V> Load(std::size_t c, V scale) const {
    const Vec3Lanes<V> v = Load(c);
    return {hn::Mul(v.x, scale), hn::Mul(v.y, scale), hn::Mul(v.z, scale)};
  }
};

/// Calls include(offset, j) with the scaled offsets of the j-th neighbours, for all j in turn.
template <class Include>
HWY_INLINE void ForNeighbors(const Neighborhoods& in, std::size_t first, const Extents& extents, V scale,
                             Include include) {
  NeighborChunk offsets;
  for (std::size_t from = 0; from < extents.most; from += kChunk) {
    offsets.FetchOffsets(in, first, extents, from);
    for (std::size_t c = 0; c < std::min(kChunk, extents.most - from); ++c) include(offsets.Load(c, scale), from + c);
  }
}

/// number(i) of the points themselves, a point per lane; 0 behind the last.
template <class Number>
HWY_INLINE V OwnNumbers(const Neighborhoods& in, std::size_t first, Number number) {
  LaneArray v = {};
  for (std::size_t l = 0; l < std::min(kLanes, in.size() - std::min(first, in.size())); ++l)
    v.of[l] = number(first + l);
  return v.Load();
}

/// Attribute `a` of the points themselves, three numbers each.
HWY_INLINE Vec3Lanes<V> OwnVectors(const Neighborhoods& in, std::size_t first, std::size_t a) {
  const auto component = [&](std::size_t c) HWY_ATTR {
    return OwnNumbers(in, first,
                      [&](std::size_t i) HWY_ATTR { return double(in.value<std::array<float, 3>>(a, i)[c]); });
  };
  return {component(0), component(1), component(2)};
}

HWY_INLINE V Length2(V x, V y, V z) { return hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)); }

/// θ(r) = exp(-r²/2σ²), σ² = π max_j |p_j - p_i|² / |N_i| (Equation 1), of a point per lane. On a surface of even
/// density σ is the point spacing, and whatever |N_i| is, the weights add up to about 2π neighbours' worth.
///
/// Two factors are taken out of every sum: offsets are scaled by the power of two that brings the farthest neighbour to
/// about 1, so that no extent of a cloud under- or overflows; and θ is divided by θ of the nearest neighbour that is
/// not on p_i, so that it does not vanish for every one of many thousand neighbours.
struct Weighting {
  V count, scale, near2, falloff;

  explicit Weighting(const Extents& extents) {
    const Lanes d;
    scale = ReciprocalOfPower(d, PowerOfTwoBelow(d, extents.largest.Load()));
    count = extents.count.Load();
    near2 = ScaledLength2(extents.near);
    falloff = hn::Div(hn::Mul(count, hn::Set(d, 0.5 / std::numbers::pi)), ScaledLength2(extents.far));  // 1 / 2σ²
  }
  V Scaled(const LaneArray& a) const { return hn::Mul(a.Load(), scale); }
  V ScaledLength2(const LaneArray (&a)[3]) const { return Length2(Scaled(a[0]), Scaled(a[1]), Scaled(a[2])); }
  /// Of the j-th neighbours, at scaled offsets; 0 behind the last.
  HWY_INLINE V Theta(const Vec3Lanes<V>& offset, std::size_t j) const {
    const Lanes d;
    const V beyond = hn::Max(hn::Sub(Length2(offset.x, offset.y, offset.z), near2), hn::Zero(d));
    return hn::IfThenElseZero(hn::Lt(hn::Set(d, double(j)), count), ExpNegative(d, hn::Mul(beyond, falloff)));
  }
  /// θ of the nearest neighbour
  HWY_INLINE V NearestTheta() const { return ExpNegative(Lanes(), hn::Mul(near2, falloff)); }
  /// A component of a scaled offset is wrong by at most 2^-52 of the coordinate: half an ulp of p_i and half an ulp of
  /// p_j.
  V Rounding(const Extents& extents) const { return hn::Mul(Scaled(extents.place), hn::Set(Lanes(), 0x1p-51)); }
};

/// m + weight · v v^T
HWY_INLINE void AddOuterProduct(Symmetric3Lanes<V>& m, V weight, const Vec3Lanes<V>& v) {
  const V x = v.x, y = v.y, z = v.z;
  const V tx = hn::Mul(weight, x), ty = hn::Mul(weight, y), tz = hn::Mul(weight, z);
  m.xx = hn::Add(m.xx, hn::Mul(tx, x));
  m.xy = hn::Add(m.xy, hn::Mul(tx, y));
  m.xz = hn::Add(m.xz, hn::Mul(tx, z));
  m.yy = hn::Add(m.yy, hn::Mul(ty, y));
  m.yz = hn::Add(m.yz, hn::Mul(ty, z));
  m.zz = hn::Add(m.zz, hn::Mul(tz, z));
}

HWY_INLINE Symmetric3Lanes<V> ZeroMatrix() {
  const V zero = hn::Zero(Lanes());
  return {zero, zero, zero, zero, zero, zero};
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
