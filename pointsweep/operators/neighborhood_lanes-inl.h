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
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "pointsweep/math/eigen3_lanes-inl.h"
#include "pointsweep/math/exp_lanes-inl.h"
#include "pointsweep/operators/neighbor_tiles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {

/// What must be known of the neighbourhoods of a tile before their sums begin. Neighbours come nearest first, so the
/// last is the farthest.
struct Extents {
  TileArray count;    // |N_i|
  TileArray largest;  // largest magnitude among the components of the last offset
  TileArray far[3];   // the last offset
  TileArray near[3];  // the first offset that is not 0
  TileArray place;    // largest magnitude among the coordinates of p_i

  /// Points whose neighbours all lie on p_i, or one of them too far away, have none from here on.
  HWY_INLINE Extents(Tile& tile, Offsets& offsets) {
    for (std::size_t l = 0; l < tile.vectors * kLanes; ++l) {
      Measure(tile, offsets, l);
      count.of[l] = double(tile.count[l]);
    }
  }

 private:
  HWY_INLINE void Measure(Tile& tile, Offsets& offsets, std::size_t l) {
    const std::size_t k = tile.count[l];
    Vec3 last{1, 0, 0}, nearest = last, p;
    double extent = 1;
    if (k > 0) {
      const auto offset = [&](std::size_t j) HWY_ATTR {
        return j < tile.chunk ? offsets.Of(l, j) : tile.in.offset(tile.first + l, j);
      };
      p = tile.in.position(tile.first + l);
      last = offset(k - 1);
      extent = Magnitude(last);
      std::size_t j = 0;
      while (j + 1 < k && offset(j) == Vec3{}) ++j;
      nearest = offset(j);
      // Power-of-two scaling needs a normal number with a normal reciprocal.
      if (!(extent >= std::numeric_limits<double>::min() && extent < 0x1p1022)) {
        offsets.Clear(l);
        tile.count[l] = 0, extent = 1;
        last = nearest = {1, 0, 0};
      }
    }
    largest.of[l] = extent;
    for (int axis = 0; axis < 3; ++axis) far[axis].of[l] = last[axis], near[axis].of[l] = nearest[axis];
    place.of[l] = Magnitude(p);
  }
  static HWY_INLINE double Magnitude(Vec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }
};

/// θ(r) = exp(-r²/2σ²), σ² = π max_j |p_j - p_i|² / |N_i| (Equation 1), of a point per lane. On a surface of even
/// density σ is the point spacing, and whatever |N_i| is, the weights add up to about 2π neighbours' worth.
///
/// Two factors are taken out of every sum: offsets are scaled by the power of two that brings the farthest neighbour to
/// about 1, so that no extent of a cloud under- or overflows; and θ is divided by θ of the nearest neighbour that is
/// not on p_i, so that it does not vanish for every one of many thousand neighbours.
struct Weighting {
  V count, scale, near2, falloff, rounding;

  Weighting(const Extents& extents, std::size_t vector) {
    const Lanes d;
    const auto length2 = [&](const TileArray(&a)[3]) HWY_ATTR {
      const Vec3Lanes<V> scaled = Scaled({a[0].Load(vector), a[1].Load(vector), a[2].Load(vector)});
      return Dot(scaled, scaled);
    };
    scale = ReciprocalOfPower(d, PowerOfTwoBelow(d, extents.largest.Load(vector)));
    count = extents.count.Load(vector);
    near2 = length2(extents.near);
    falloff = hn::Div(hn::Mul(count, hn::Set(d, 0.5 / std::numbers::pi)), length2(extents.far));  // 1 / 2σ²
    // A component of a scaled offset is wrong by at most 2^-52 of the coordinate: half an ulp of p_i and half an ulp of
    // p_j.
    rounding = hn::Mul(hn::Mul(extents.place.Load(vector), scale), hn::Set(d, 0x1p-51));
  }
  HWY_INLINE Vec3Lanes<V> Scaled(const Vec3Lanes<V>& offset) const { return Times(scale, offset); }
  /// Of the j-th neighbours, at scaled offsets; 0 behind the last.
  HWY_INLINE V Theta(const Vec3Lanes<V>& offset, std::size_t j) const {
    const Lanes d;
    const V beyond = hn::Max(hn::Sub(Dot(offset, offset), near2), hn::Zero(d));
    return hn::IfThenElseZero(hn::Lt(hn::Set(d, double(j)), count), ExpNegative(d, hn::Mul(beyond, falloff)));
  }
  /// θ of the nearest neighbour
  HWY_INLINE V NearestTheta() const { return ExpNegative(Lanes(), hn::Mul(near2, falloff)); }
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

/// m + v v^T
HWY_INLINE void AddOuterProduct(Symmetric3Lanes<V>& m, const Vec3Lanes<V>& v) {
  m.xx = hn::Add(m.xx, hn::Mul(v.x, v.x));
  m.xy = hn::Add(m.xy, hn::Mul(v.x, v.y));
  m.xz = hn::Add(m.xz, hn::Mul(v.x, v.z));
  m.yy = hn::Add(m.yy, hn::Mul(v.y, v.y));
  m.yz = hn::Add(m.yz, hn::Mul(v.y, v.z));
  m.zz = hn::Add(m.zz, hn::Mul(v.z, v.z));
}

HWY_INLINE Symmetric3Lanes<V> ZeroMatrix() {
  const V zero = hn::Zero(Lanes());
  return {zero, zero, zero, zero, zero, zero};
}

/// Σ_j o o^T θ of Equation 1 and Σ_j θ, both without the factors that Weighting takes out; 1/|N_i| is left out
/// likewise.
struct Moments {
  Weighting weighting;
  Symmetric3Lanes<V> m = ZeroMatrix();
  V weights = hn::Zero(Lanes());

  HWY_INLINE void Include(const Vec3Lanes<V>& offset, std::size_t j) {
    const Vec3Lanes<V> scaled = weighting.Scaled(offset);
    const V theta = weighting.Theta(scaled, j);
    AddOuterProduct(m, theta, scaled);
    weights = hn::Add(weights, theta);
  }
};

HWY_INLINE Moments SumMoments(const Tile& tile, const Extents& extents, Offsets& offsets, std::size_t vector) {
  Moments moments{Weighting(extents, vector)};
  ForNeighbors(tile, offsets, vector, moments);
  return moments;
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
