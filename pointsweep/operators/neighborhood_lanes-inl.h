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
    for (std::size_t v = 0; v < tile.vectors; ++v) {
      const bool together = MeasureTogether(tile, offsets, v);
      for (std::size_t l = v * kLanes; l < (v + 1) * kLanes; ++l) {
        if (!together) Measure(tile, offsets, l);
        count.of[l] = double(tile.count[l]);
      }
    }
  }

 private:
  /// The usual case of Measure(), a vector of points at a time; false if it is not that: as many neighbours for each,
  /// all of them at hand, the first not on the point, the last not too far away.
  HWY_INLINE bool MeasureTogether(const Tile& tile, const Offsets& offsets, std::size_t v) {
    const Lanes d;
    const std::size_t begin = v * kLanes, k = tile.count[begin];
    if (k == 0 || k > tile.chunk) return false;
    for (std::size_t l = begin + 1; l < begin + kLanes; ++l)
      if (tile.count[l] != k) return false;
    const Vec3Lanes<V> first = offsets.Load(v, 0), last = offsets.Load(v, k - 1);
    const auto magnitude = [](const Vec3Lanes<V>& a)
                               HWY_ATTR { return hn::Max(hn::Max(hn::Abs(a.x), hn::Abs(a.y)), hn::Abs(a.z)); };
    const V extent = magnitude(last);
    const auto scalable = hn::And(hn::Ge(extent, hn::Set(d, kLeastExtent)), hn::Lt(extent, hn::Set(d, kTooFar)));
    if (!hn::AllTrue(d, hn::And(scalable, hn::Gt(magnitude(first), hn::Zero(d))))) return false;
    hn::Store(extent, d, largest.of + begin);
    const V far_of[3] = {last.x, last.y, last.z}, near_of[3] = {first.x, first.y, first.z};
    for (int axis = 0; axis < 3; ++axis) {
      hn::Store(far_of[axis], d, far[axis].of + begin);
      hn::Store(near_of[axis], d, near[axis].of + begin);
    }
    for (std::size_t l = begin; l < begin + kLanes; ++l) place.of[l] = Magnitude(tile.in.position(tile.first + l));
    return true;
  }
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
      if (!(extent >= kLeastExtent && extent < kTooFar)) {
        offsets.Clear(l);
        tile.count[l] = 0, extent = 1;
        last = nearest = {1, 0, 0};
      }
    }
    largest.of[l] = extent;
    for (int axis = 0; axis < 3; ++axis) far[axis].of[l] = last[axis], near[axis].of[l] = nearest[axis];
    place.of[l] = Magnitude(p);
  }
  // Power-of-two scaling needs a normal number with a normal reciprocal.
  static constexpr double kLeastExtent = std::numeric_limits<double>::min(), kTooFar = 0x1p1022;
  static HWY_INLINE double Magnitude(Vec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }
};

/// Offsets are scaled by the power of two that brings the farthest neighbour to about 1, so that no extent of a cloud
/// under- or overflows. A point per lane.
struct Scaling {
  V scale;
  V rounding;  // of a scaled offset's components

  Scaling(const Extents& extents, std::size_t vector) {
    const Lanes d;
    scale = ReciprocalOfPower(d, PowerOfTwoBelow(d, extents.largest.Load(vector)));
    // Each is wrong by at most 2^-52 of the coordinate: half an ulp of p_i and half an ulp of p_j.
    rounding = hn::Mul(hn::Mul(extents.place.Load(vector), scale), hn::Set(d, 0x1p-51));
  }
  HWY_INLINE Vec3Lanes<V> Scaled(const Vec3Lanes<V>& offset) const { return Times(scale, offset); }
};

/// θ(r) = exp(-r²/2σ²), σ² = π max_j |p_j - p_i|² / |N_i| (Equation 1), of a point per lane. On a surface of even
/// density σ is the point spacing, and whatever |N_i| is, the weights add up to about 2π neighbours' worth.
///
/// θ is divided by θ of the nearest neighbour that is not on p_i, so that it does not vanish for every one of many
/// thousand neighbours.
struct Weighting {
  Scaling scaling;
  V count, near2, falloff;

  Weighting(const Extents& extents, std::size_t vector) : scaling(extents, vector) {
    const auto length2 = [&](const TileArray(&a)[3]) HWY_ATTR {
      const Vec3Lanes<V> v = scaling.Scaled({a[0].Load(vector), a[1].Load(vector), a[2].Load(vector)});
      return Dot(v, v);
    };
    count = extents.count.Load(vector);
    near2 = length2(extents.near);
    falloff = hn::Div(hn::Mul(count, hn::Set(Lanes(), 0.5 / std::numbers::pi)), length2(extents.far));  // 1 / 2σ²
  }
  /// -ln θ of the j-th neighbours, so large behind the last that θ is 0.
  HWY_INLINE V Exponent(const Vec3Lanes<V>& offset, std::size_t j) const {
    const Lanes d;
    const Vec3Lanes<V> scaled = scaling.Scaled(offset);
    const V exponent = hn::Mul(hn::Max(hn::Sub(Dot(scaled, scaled), near2), hn::Zero(d)), falloff);
    return hn::IfThenElse(hn::Lt(hn::Set(d, double(j)), count), exponent, hn::Set(d, 1000.0));
  }
};

/// θ of all neighbours of a tile, in single precision. That changes each term of a sum by less than 1e-7 of the
/// greatest, in proportion to its own size along every direction: small eigenvalues keep their digits, and the first
/// eigenvector turns by about 1e-7 λ1 / (λ1 - λ0).
class Weights {
 public:
  Weights(const Tile& tile, const Extents& extents, Offsets& offsets)
      : tile_(tile), extents_(extents), offsets_(offsets) {
    if (tile.size < tile.stride) std::fill(theta_.of, theta_.of + Tile::kRoom, 0.0f);
  }
  /// Makes sure that the offsets from the `from`-th neighbour on are there, and their weights.
  HWY_INLINE void Hold(std::size_t from) {
    offsets_.Hold(from);
    if (from != from_) Compute(from);
  }
  HWY_INLINE V Load(std::size_t vector, std::size_t c) const {
    return hn::PromoteTo(Lanes(), hn::Load(FloatLanes(), theta_.of + tile_.At(vector, c)));
  }
  /// θ of the nearest neighbours, by which the others are divided.
  HWY_INLINE V NearestTheta(std::size_t vector) const { return ExpNegative(Lanes(), nearest_.Load(vector)); }

 private:
  void Compute(std::size_t from) {
    from_ = from;
    for (std::size_t v = 0; v < tile_.vectors; ++v) {
      const Weighting weighting(extents_, v);
      hn::Store(hn::Mul(weighting.near2, weighting.falloff), Lanes(), nearest_.of + v * kLanes);
      for (std::size_t c = 0; c < tile_.Held(from); ++c) {
        const V exponent = weighting.Exponent(offsets_.Load(v, c), from + c);
        hn::Store(hn::DemoteTo(FloatLanes(), exponent), FloatLanes(), theta_.of + tile_.At(v, c));
      }
    }
    const hn::ScalableTag<float> d;
    for (std::size_t at = 0; at < tile_.Held(from) * tile_.stride; at += hn::Lanes(d))
      hn::Store(ExpNegative(d, hn::Load(d, theta_.of + at)), d, theta_.of + at);
  }

  const Tile& tile_;
  const Extents& extents_;
  Offsets& offsets_;
  std::size_t from_ = ~std::size_t{0};
  NeighborArray<float> theta_;
  TileArray nearest_;  // -ln θ
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

/// Σ_j o o^T θ of Equation 1 and Σ_j θ, both without the factors that Scaling and Weighting take out; 1/|N_i| is left
/// out likewise.
struct Moments {
  Scaling scaling;
  Symmetric3Lanes<V> m = ZeroMatrix();
  V weights = hn::Zero(Lanes());
};

HWY_INLINE Moments SumMoments(const Tile& tile, const Extents& extents, const Offsets& offsets, Weights& weights,
                              std::size_t vector) {
  Moments sums{Scaling(extents, vector)};
  for (std::size_t from = 0; from < tile.most; from += tile.chunk) {
    weights.Hold(from);
    for (std::size_t c = 0; c < tile.Held(from); ++c) {
      const V theta = weights.Load(vector, c);
      AddOuterProduct(sums.m, theta, sums.scaling.Scaled(offsets.Load(vector, c)));
      sums.weights = hn::Add(sums.weights, theta);
    }
  }
  return sums;
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
