// SPDX-License-Identifier: MIT
/// Measures of neighbourhoods in vector lanes, a point per lane: extents, the weights of Equation 1 of the paper
/// (normals.h), which Equation 2 (curvature.h) uses as well, and the sums of Equation 1. Included once per instruction
/// set.
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
#include "pointsweep/operators/lanes/neighbor_tiles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {

/// Measures of the neighbourhoods of a tile that are needed before the sums over neighbours begin. "Scaled" offsets are
/// those of Scaling. Without neighbours, `place` is 0, and `largest`, `far2` and `near2` are 1.
struct Extents {
  TileArray count;       // |N_i|
  TileArray largest;     // largest magnitude of a component: of the farthest offset if lists are sorted, else of all
  TileArray far2;        // scaled squared length of the farthest offset
  TileArray near2;       // scaled squared length of the nearest offset that is not 0
  TileArray coincident;  // 1 if a neighbour lies on p_i, else 0
  TileArray place;       // largest magnitude among the coordinates of p_i

  /// Measures a tile. Removes all neighbours of a point if every component of their offsets is below the least normal
  /// double in magnitude, as where all coincide with the point, or if a component is not below 2^1022.
  HWY_INLINE Extents(Tile& tile, Offsets& offsets) {
    const bool sorted = tile.in.sorted_by_distance();
    for (std::size_t v = 0; v < tile.vectors; ++v) {
      const bool together = sorted && MeasureTogether(tile, offsets, v);
      if (!sorted) MeasureAll(tile, offsets, v);
      for (std::size_t l = v * kLanes; l < (v + 1) * kLanes; ++l) {
        if (sorted && !together) MeasureEnds(tile, offsets, l);
        count.of[l] = double(tile.count[l]);
        place.of[l] = count.of[l] == 0 ? 0 : Magnitude(tile.in.position(tile.first + l));
      }
    }
  }

 private:
  /// Computes MeasureEnds() for a whole vector of points. Returns false, and measures nothing, unless all points have
  /// the same number of neighbours, at least one, all held by the tile, no first neighbour coincides with its point,
  /// and the extents of all last neighbours are ordinary (IsOrdinary()).
  HWY_INLINE bool MeasureTogether(const Tile& tile, const Offsets& offsets, std::size_t v) {
    const Lanes d;
    const std::size_t begin = v * kLanes, k = tile.count[begin];
    if (k == 0 || k > tile.chunk) return false;
    for (std::size_t l = begin + 1; l < begin + kLanes; ++l)
      if (tile.count[l] != k) return false;
    const Vec3Lanes<V> first = offsets.Load(v, 0), last = offsets.Load(v, k - 1);
    const V extent = Magnitude(last);
    if (!hn::AllTrue(d, hn::And(IsOrdinary(extent), hn::Gt(Magnitude(first), hn::Zero(d))))) return false;
    const V scale = ReciprocalOfPower(d, PowerOfTwoBelow(d, extent));
    const Vec3Lanes<V> far = Times(scale, last), near = Times(scale, first);
    hn::Store(extent, d, largest.of + begin);
    hn::Store(Dot(far, far), d, far2.of + begin);
    hn::Store(Dot(near, near), d, near2.of + begin);
    hn::Store(hn::Zero(d), d, coincident.of + begin);
    return true;
  }
  /// Measures point l, whose neighbours come nearest first: the last is the farthest, and the first that does not
  /// coincide with p_i is the nearest.
  HWY_INLINE void MeasureEnds(Tile& tile, Offsets& offsets, std::size_t l) {
    const std::size_t k = tile.count[l];
    if (k == 0) return HaveNone(l);
    const auto offset = [&](std::size_t j)
                            HWY_ATTR { return j < tile.chunk ? offsets.Of(l, j) : tile.in.offset(tile.first + l, j); };
    const Vec3 last = offset(k - 1);
    const double extent = Magnitude(last);
    if (!(extent >= kLeastOrdinary && extent < kMostOrdinary)) return Search(tile, offsets, l);
    std::size_t j = 0;
    while (j + 1 < k && offset(j) == Vec3{}) ++j;
    const double scale = reciprocal_of_power(power_of_two_below(extent));
    largest.of[l] = extent, far2.of[l] = Length2(scale * last), near2.of[l] = Length2(scale * offset(j));
    coincident.of[l] = j > 0 ? 1 : 0;
  }
  /// Measures vector v of points, whose neighbours come in any order.
  HWY_INLINE void MeasureAll(Tile& tile, Offsets& offsets, std::size_t v) {
    const Lanes d;
    const std::size_t begin = v * kLanes;
    AnyOrder all;
    ForNeighbors(tile, offsets, v, all);
    const V scale = ReciprocalOfPower(d, PowerOfTwoBelow(d, all.largest));
    hn::Store(all.largest, d, largest.of + begin);
    hn::Store(hn::Mul(hn::Mul(all.far2, scale), scale), d, far2.of + begin);
    hn::Store(hn::Mul(hn::Mul(all.near2, scale), scale), d, near2.of + begin);
    LaneArray off, ordinary;
    hn::Store(all.off, d, off.of);
    hn::Store(hn::IfThenElseZero(hn::And(all.reachable, IsOrdinary(all.largest)), hn::Set(d, 1.0)), d, ordinary.of);
    for (std::size_t l = begin; l < begin + kLanes; ++l) {
      coincident.of[l] = off.of[l - begin] < double(tile.count[l]) ? 1 : 0;
      if (ordinary.of[l - begin] == 0) tile.count[l] == 0 ? HaveNone(l) : Search(tile, offsets, l);
    }
  }
  /// Measures point l, whose neighbours come in any order, at distances whose squares may under- or overflow. Removes
  /// the neighbours under the conditions of the constructor.
  HWY_INLINE void Search(Tile& tile, Offsets& offsets, std::size_t l) {
    const std::size_t k = tile.count[l], i = tile.first + l;
    double extent = 0;
    bool reachable = true;
    for (std::size_t j = 0; j < k; ++j) {
      const Vec3 o = tile.in.offset(i, j);
      reachable = reachable && std::abs(o.x) < kTooFar && std::abs(o.y) < kTooFar && std::abs(o.z) < kTooFar;
      extent = std::max(extent, Magnitude(o));
    }
    if (!reachable || !(extent >= kLeastExtent)) {
      offsets.Clear(l);
      tile.count[l] = 0;
      return HaveNone(l);
    }
    const double scale = reciprocal_of_power(power_of_two_below(extent));
    largest.of[l] = extent, far2.of[l] = 0, coincident.of[l] = 0;
    near2.of[l] = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < k; ++j) {
      const Vec3 o = tile.in.offset(i, j);
      const double length2 = Length2(scale * o);
      far2.of[l] = std::max(far2.of[l], length2);
      o == Vec3{} ? coincident.of[l] = 1 : near2.of[l] = std::min(near2.of[l], length2);
    }
  }
  void HaveNone(std::size_t l) { largest.of[l] = far2.of[l] = near2.of[l] = 1, coincident.of[l] = 0; }

  /// Finds extents of unscaled offsets in any order; zeros after a point's last neighbour do not count.
  struct AnyOrder {
    V largest, far2, near2, off;
    hn::Mask<Lanes> reachable;

    HWY_INLINE AnyOrder() {
      largest = far2 = off = hn::Zero(Lanes());
      near2 = hn::Set(Lanes(), std::numeric_limits<double>::infinity());
      reachable = hn::Eq(off, off);
    }
    HWY_INLINE void Include(const Vec3Lanes<V>& o) {
      const Lanes d;
      const V too_far = hn::Set(d, kTooFar), size = Magnitude(o), length2 = Dot(o, o);
      const auto within =
          hn::And(hn::And(hn::Lt(hn::Abs(o.x), too_far), hn::Lt(hn::Abs(o.y), too_far)), hn::Lt(hn::Abs(o.z), too_far));
      const auto is_off = hn::Gt(size, hn::Zero(d));
      reachable = hn::And(reachable, within);
      largest = hn::IfThenElse(hn::Gt(size, largest), size, largest);
      far2 = hn::IfThenElse(hn::Gt(length2, far2), length2, far2);
      near2 = hn::IfThenElse(hn::And(is_off, hn::Lt(length2, near2)), length2, near2);
      off = hn::Add(off, hn::IfThenElseZero(is_off, hn::Set(d, 1.0)));
    }
  };

  // Power-of-two scaling needs a normal number with a normal reciprocal; squares of ordinary lengths are normal numbers
  // as well, so that they have the order of the lengths.
  static constexpr double kLeastExtent = std::numeric_limits<double>::min(), kTooFar = 0x1p1022;
  static constexpr double kLeastOrdinary = 0x1p-500, kMostOrdinary = 0x1p500;
  static HWY_INLINE hn::Mask<Lanes> IsOrdinary(V extent) {
    const Lanes d;
    return hn::And(hn::Ge(extent, hn::Set(d, kLeastOrdinary)), hn::Lt(extent, hn::Set(d, kMostOrdinary)));
  }
  static HWY_INLINE V Magnitude(const Vec3Lanes<V>& v) {
    return hn::Max(hn::Max(hn::Abs(v.x), hn::Abs(v.y)), hn::Abs(v.z));
  }
  static HWY_INLINE double Magnitude(Vec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }
  static HWY_INLINE double Length2(Vec3 v) { return (v.x * v.x + v.y * v.y) + v.z * v.z; }
};

/// Offsets are scaled by the power of two that brings Extents::largest into [1, 2), so that no extent of a cloud under-
/// or overflows. A point per lane.
struct Scaling {
  V scale;
  V rounding;  // bound of the rounding error of the components of a scaled offset

  Scaling(const Extents& extents, std::size_t vector) {
    const Lanes d;
    scale = ReciprocalOfPower(d, PowerOfTwoBelow(d, extents.largest.Load(vector)));
    // The error of an offset is about 2^-52 of the coordinate, half an ulp each of p_i and p_j. 2^-51 leaves a margin.
    rounding = hn::Mul(hn::Mul(extents.place.Load(vector), scale), hn::Set(d, 0x1p-51));
  }
  HWY_INLINE Vec3Lanes<V> Scaled(const Vec3Lanes<V>& offset) const { return Times(scale, offset); }
};

/// θ(r) = exp(-r²/2σ²), σ² = π max_j |p_j - p_i|² / |N_i| (Equation 1), for a point per lane. On a surface of even
/// density σ is the point spacing, and the sum of θ is about 2π for any large |N_i|. The weights are θ divided by θ of
/// the nearest neighbour that does not coincide with p_i, so that not all of many thousand weights underflow.
/// Neighbours that coincide with p_i get the weight 1, too, since their offsets add nothing to a sum over positions;
/// other sums need Weights::LoadTrue().
struct Weighting {
  Scaling scaling;
  V count, near2, falloff;

  Weighting(const Extents& extents, std::size_t vector) : scaling(extents, vector) {
    count = extents.count.Load(vector);
    near2 = extents.near2.Load(vector);
    falloff = hn::Div(hn::Mul(count, hn::Set(Lanes(), 0.5 / std::numbers::pi)), extents.far2.Load(vector));  // 1 / 2σ²
  }
  /// Returns -ln of the weights of the j-th neighbours, from j = 0; after a point's last neighbour it is so large that
  /// the weight is 0.
  HWY_INLINE V Exponent(const Vec3Lanes<V>& offset, std::size_t j) const {
    const Lanes d;
    const Vec3Lanes<V> scaled = scaling.Scaled(offset);
    const V exponent = hn::Mul(hn::Max(hn::Sub(Dot(scaled, scaled), near2), hn::Zero(d)), falloff);
    return hn::IfThenElse(hn::Lt(hn::Set(d, double(j)), count), exponent, hn::Set(d, 1000.0));
  }
};

/// The weights of the neighbours that a tile holds, in single precision. The relative error of a weight is below 1e-7
/// and scales a whole term θ o o^T of the sum, in all directions alike: small eigenvalues keep their digits, and the
/// eigenvector of λ0 turns by about 1e-7 λ1 / (λ1 - λ0).
class Weights {
 public:
  Weights(const Tile& tile, const Extents& extents, Offsets& offsets)
      : tile_(tile), extents_(extents), offsets_(offsets) {
    if (tile.size < tile.stride) std::fill(theta_.of, theta_.of + Tile::kRoom, 0.0f);
  }
  /// Loads the offsets from neighbour `from` on and computes their weights, unless they are already loaded.
  HWY_INLINE void Hold(std::size_t from) {
    offsets_.Hold(from);
    if (from != from_) Compute(from);
  }
  HWY_INLINE V Load(std::size_t vector, std::size_t c) const {
    return hn::PromoteTo(Lanes(), hn::Load(FloatLanes(), theta_.of + tile_.At(vector, c)));
  }
  /// Returns θ / Divisor() for sums over values that are not 0 at p_i: correct also for neighbours that coincide with
  /// p_i. If there are such neighbours, the weight after the point's last neighbour is 1, not 0.
  HWY_INLINE V LoadTrue(std::size_t vector, std::size_t c) const {
    const V theta = Load(vector, c), coincident = extents_.coincident.Load(vector), zero = hn::Zero(Lanes());
    const auto some = hn::Gt(coincident, zero);
    if (hn::AllFalse(Lanes(), some)) return theta;
    const Vec3Lanes<V> o = offsets_.Load(vector, c);
    const auto on_point = hn::And(hn::And(hn::Eq(o.x, zero), hn::Eq(o.y, zero)), hn::Eq(o.z, zero));
    const V absolute = hn::IfThenElse(on_point, coincident, hn::Mul(theta, NearestTheta(vector)));
    return hn::IfThenElse(some, absolute, theta);
  }
  /// Returns the divisor of θ in LoadTrue(): θ of the nearest neighbour, which is 1 if a neighbour lies on p_i.
  HWY_INLINE V Divisor(std::size_t vector) const {
    const auto some = hn::Gt(extents_.coincident.Load(vector), hn::Zero(Lanes()));
    return hn::IfThenElse(some, hn::Set(Lanes(), 1.0), NearestTheta(vector));
  }

 private:
  HWY_INLINE V NearestTheta(std::size_t vector) const { return ExpNegative(Lanes(), nearest_.Load(vector)); }
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
  TileArray nearest_;  // -ln θ of the nearest neighbour off p_i
};

/// Adds weight · v v^T to m.
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

/// Adds v v^T to m.
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

/// The sums Σ_j θ o o^T (Equation 1 without 1/|N_i|) and Σ_j θ over the neighbours j. o is p_j - p_i times
/// Scaling::scale, and θ is divided by the θ of the nearest neighbour off p_i, and is 1 for neighbours on p_i
/// (Weighting).
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
