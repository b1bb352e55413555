// SPDX-License-Identifier: MIT
#include <cstddef>
#include <limits>

#include "pointsweep/math/instruction_sets.h"
#include "pointsweep/operators/surface/features.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pointsweep/operators/surface/features_kernel.cpp"
#include <hwy/foreach_target.h>
// The lanes must be included after foreach_target.h, which includes this file for each instruction set.
#include "pointsweep/math/exp_lanes-inl.h"
#include "pointsweep/operators/lanes/column_lanes-inl.h"
#include "pointsweep/operators/lanes/neighborhood_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {

using Vector = Vec3Lanes<V>;
using Matrix = Symmetric3Lanes<V>;

template <class M>
HWY_INLINE Vector OrZero(M mask, const Vector& a) {
  return {hn::IfThenElseZero(mask, a.x), hn::IfThenElseZero(mask, a.y), hn::IfThenElseZero(mask, a.z)};
}

/// Sums over the scaled offsets of the points of a neighbourhood from an origin: p_i if it counts, else its first
/// neighbour. Sums of squares about a point of the set exceed sums of squares about the mean at most by a factor of the
/// number of points, so that Centered() keeps its digits even if p_i is far from its neighbours.
struct PointSums {
  Scaling scaling;
  V points;       // n
  Vector origin;  // scaled offset from p_i to the origin of the sums
  Vector offset;
  Matrix products = ZeroMatrix();
  V low, high;  // least and greatest z of the offsets

  HWY_INLINE PointSums(const Extents& extents, const Offsets& offsets, std::size_t v, bool with_point)
      : scaling(extents, v) {
    const V zero = hn::Zero(Lanes()), count = extents.count.Load(v);
    points = with_point ? hn::Add(count, hn::Set(Lanes(), 1.0)) : count;
    origin = with_point ? Vector{zero, zero, zero} : scaling.Scaled(offsets.Load(v, 0));
    offset = {zero, zero, zero};
    low = high = zero;
  }
  HWY_INLINE void Include(const Vector& o) {
    AddOuterProduct(products, o);
    offset = Plus(offset, o);
    low = hn::Min(low, o.z), high = hn::Max(high, o.z);
  }
  /// Returns n Σ of the scaled offsets, Σ as in Features.
  HWY_INLINE Matrix Centered() const {
    Matrix m = products;
    const V one = hn::Set(Lanes(), 1.0);
    AddOuterProduct(m, hn::Neg(hn::Div(one, hn::Max(points, one))), offset);
    return m;
  }
};

/// Returns the sums over the neighbourhoods of a vector of points.
template <bool kWithPoint>
HWY_INLINE PointSums SumPoints(const Tile& tile, const Extents& extents, Offsets& offsets, std::size_t v) {
  const Lanes d;
  offsets.Hold(0);
  PointSums sums(extents, offsets, v, kWithPoint);
  for (std::size_t from = 0; from < tile.most; from += tile.chunk) {
    offsets.Hold(from);
    for (std::size_t c = 0; c < tile.Held(from); ++c) {
      const Vector o = sums.scaling.Scaled(offsets.Load(v, c));
      // After a point's last neighbour the offsets are 0. They change no sum, and no extreme z, since p_i has the
      // offset 0, too.
      if constexpr (kWithPoint) {
        sums.Include(o);
      } else {
        const auto is_there = hn::Lt(hn::Set(d, double(from + c)), sums.points);
        sums.Include(OrZero(is_there, Minus(o, sums.origin)));
      }
    }
  }
  return sums;
}

/// The values λ1 >= λ2 >= λ3 of the formulas in the scale that the user has chosen, divided by unit^power.
struct Values {
  V v1, v2, v3, sum;
  V unit;     // length that corresponds to 1 in scaled offsets
  int power;  // exponent of the length in the values

  HWY_INLINE Values(const PointSums& sums, const Eigen3Lanes<V>& e, EigenvalueScale scale) {
    const Lanes d;
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0), share = hn::Div(one, hn::Max(sums.points, one));
    v1 = hn::Mul(hn::Max(e.value2, zero), share);
    v2 = hn::Mul(hn::Max(e.value1, zero), share);
    v3 = hn::Mul(hn::Max(e.value0, zero), share);
    if (scale == EigenvalueScale::root) v1 = hn::Sqrt(v1), v2 = hn::Sqrt(v2), v3 = hn::Sqrt(v3);
    sum = hn::Add(hn::Add(v1, v2), v3);
    if (scale == EigenvalueScale::normalized) {
      v1 = hn::Div(v1, sum), v2 = hn::Div(v2, sum), v3 = hn::Div(v3, sum);
      sum = hn::Add(hn::Add(v1, v2), v3);
    }
    unit = ReciprocalOfPower(d, sums.scaling.scale);
    power = scale == EigenvalueScale::raw ? 2 : scale == EigenvalueScale::root ? 1 : 0;
  }
  HWY_INLINE V InUnits(V v, int exponent) const {
    for (int i = 0; i < exponent; ++i) v = hn::Mul(v, unit);
    return v;
  }
};

/// The features that are computed from logarithms of the values; 0 ln 0 is 0.
struct Logarithms {
  V omnivariance, eigenentropy;

  HWY_INLINE explicit Logarithms(const Values& v) {
    const Lanes d;
    const V least = hn::Set(d, std::numeric_limits<double>::min());
    const auto some2 = hn::Ge(v.v2, least), some3 = hn::Ge(v.v3, least);
    const V ln1 = NaturalLogarithm(d, hn::Max(v.v1, least)), ln2 = NaturalLogarithm(d, hn::Max(v.v2, least));
    const V ln3 = NaturalLogarithm(d, hn::Max(v.v3, least));
    // ∛(λ1 λ2 λ3) = λ1 ∛((λ2/λ1) (λ3/λ1)), with both quotients at most 1.
    const V fall = hn::Mul(hn::Add(hn::Sub(ln1, ln2), hn::Sub(ln1, ln3)), hn::Set(d, 1.0 / 3));
    const V mean = hn::Mul(v.v1, ExpNegative(d, hn::Max(fall, hn::Zero(d))));
    omnivariance = v.InUnits(hn::IfThenElseZero(hn::And(some2, some3), mean), v.power);
    const V terms = hn::Add(hn::Add(hn::Mul(v.v1, ln1), hn::IfThenElseZero(some2, hn::Mul(v.v2, ln2))),
                            hn::IfThenElseZero(some3, hn::Mul(v.v3, ln3)));
    const V ln_unit = hn::Mul(BinaryExponent(d, v.unit), hn::Set(d, v.power * 0.69314718055994530942));
    eigenentropy = v.InUnits(hn::Neg(hn::Add(terms, hn::Mul(ln_unit, v.sum))), v.power);
  }
};

/// Features of a vector of points.
class FeatureLanes {
 public:
  HWY_INLINE FeatureLanes(const FeatureColumns& out, const Points& points, const PointSums& sums)
      : out_(out), points_(points), sums_(sums) {}

  HWY_INLINE void StoreHeight() const {
    const V height = hn::Mul(hn::Sub(sums_.high, sums_.low), ReciprocalOfPower(Lanes(), sums_.scaling.scale));
    StoreNumbers(height, points_, out_[Feature::height_range]);
  }
  /// Marks points without extent as degenerate if FeatureColumns::marks_without_extent. `centered`: sums_.Centered().
  HWY_INLINE void MarkPlaces(const Matrix& centered, DegeneratePoints& degenerate) const {
    if (out_.marks_without_extent) points_.MarkWithout(HasExtent(centered), degenerate);
  }
  HWY_INLINE void StoreAll(const Matrix& centered, const Eigen3Lanes<V>& e, DegeneratePoints& degenerate) const {
    const auto found = HasExtent(centered);
    const Values v(sums_, e, out_.eigenvalues);
    StoreShapes(found, v);
    if (!out_[Feature::omnivariance].empty() || !out_[Feature::eigenentropy].empty()) {
      const Logarithms logarithms(v);
      Store(Feature::omnivariance, found, logarithms.omnivariance);
      Store(Feature::eigenentropy, found, logarithms.eigenentropy);
    }
    StoreVerticality(found, e, degenerate);
    StoreMoments(found, e.vector2, v, Feature::moment1_axis1, Feature::moment2_axis1);
    StoreMoments(found, e.vector1, v, Feature::moment1_axis2, Feature::moment2_axis2);
  }

 private:
  using Mask = hn::Mask<Lanes>;

  HWY_INLINE void Store(Feature f, Mask found, V v) const {
    StoreNumbers(hn::IfThenElseZero(found, v), points_, out_[f]);
  }
  static HWY_INLINE Mask HasExtent(const Matrix& centered) {
    return hn::Gt(hn::Add(hn::Add(centered.xx, centered.yy), centered.zz), hn::Zero(Lanes()));
  }
  HWY_INLINE void StoreShapes(Mask found, const Values& v) const {
    const V inverse = hn::Div(hn::Set(Lanes(), 1.0), v.v1);
    Store(Feature::linearity, found, hn::Mul(hn::Sub(v.v1, v.v2), inverse));
    Store(Feature::planarity, found, hn::Mul(hn::Sub(v.v2, v.v3), inverse));
    Store(Feature::sphericity, found, hn::Mul(v.v3, inverse));
    Store(Feature::anisotropy, found, hn::Mul(hn::Sub(v.v1, v.v3), inverse));
    Store(Feature::eigenvalue_sum, found, v.InUnits(v.sum, v.power));
    Store(Feature::surface_variation, found, hn::Div(v.v3, v.sum));
  }
  HWY_INLINE void StoreVerticality(Mask found, const Eigen3Lanes<V>& e, DegeneratePoints& degenerate) const {
    const Lanes d;
    const V rounding = sums_.scaling.rounding, noise = hn::Mul(sums_.points, hn::Mul(rounding, rounding));
    const auto plane = hn::And(found, hn::Gt(e.value1, hn::Add(hn::Mul(hn::Set(d, 1e-12), e.value2), noise)));
    if (out_.marks_lines) points_.MarkWithout(plane, degenerate);
    const V verticality = hn::Sub(hn::Set(d, 1.0), hn::Abs(e.vector0.z));
    Store(Feature::verticality, plane, hn::Max(verticality, hn::Zero(d)));
  }
  /// Stores moments of the offsets from p_i along a unit vector: the sum's magnitude, and the sum of squares.
  HWY_INLINE void StoreMoments(Mask found, const Vector& axis, const Values& v, Feature first, Feature second) const {
    if (out_[first].empty() && out_[second].empty()) return;
    const V sum = Dot(sums_.offset, axis), squares = Dot(axis, Times(sums_.products, axis));
    const V origin = Dot(sums_.origin, axis), shift = hn::Mul(sums_.points, origin);
    Store(first, found, v.InUnits(hn::Abs(hn::Add(sum, shift)), 1));
    const V about_point = hn::Add(squares, hn::Mul(origin, hn::Add(hn::Add(sum, sum), shift)));
    Store(second, found, v.InUnits(hn::Max(about_point, hn::Zero(Lanes())), 2));
  }

  const FeatureColumns& out_;
  const Points& points_;
  const PointSums& sums_;
};

/// Returns whether a wanted feature, or FeatureColumns::marks_lines, needs eigenvalues or eigenvectors.
bool NeedsEigenvalues(const FeatureColumns& out) {
  for (std::size_t f = 0; f < static_cast<std::size_t>(Feature::height_range); ++f)
    if (!out.numbers[f].empty()) return true;
  return out.marks_lines;
}

template <bool kWithPoint>
void FeaturesOf(const Neighborhoods& in, const FeatureColumns& out, DegeneratePoints& degenerate) {
  const bool needs_eigenvalues = NeedsEigenvalues(out);
  for (std::size_t first = 0; first < in.size();) {
    Tile tile(in, first, in.size());
    Offsets offsets(tile, {in});
    const Extents extents(tile, offsets);
    for (std::size_t v = 0; v < tile.vectors; v += 2) {
      const bool both = v + 1 < tile.vectors;
      const PointSums a = SumPoints<kWithPoint>(tile, extents, offsets, v);
      const PointSums b = both ? SumPoints<kWithPoint>(tile, extents, offsets, v + 1) : a;
      const Points points_a(tile, v), points_b(tile, v + 1);  // the second may be empty
      const FeatureLanes lanes_a(out, points_a, a), lanes_b(out, points_b, b);
      const Matrix centered_a = a.Centered(), centered_b = b.Centered();
      lanes_a.StoreHeight(), lanes_b.StoreHeight();
      lanes_a.MarkPlaces(centered_a, degenerate), lanes_b.MarkPlaces(centered_b, degenerate);
      if (!needs_eigenvalues) continue;
      const auto eigen = EigenSymmetric3(Lanes(), centered_a, centered_b);
      lanes_a.StoreAll(centered_a, eigen[0], degenerate);
      if (both) lanes_b.StoreAll(centered_b, eigen[1], degenerate);
    }
    first += tile.size;
  }
}

void Features(const Neighborhoods& in, const FeatureColumns& out, DegeneratePoints& degenerate) {
  out.with_point ? FeaturesOf<true>(in, out, degenerate) : FeaturesOf<false>(in, out, degenerate);
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointsweep {

HWY_EXPORT(Features);

void features(const Neighborhoods& in, const FeatureColumns& out, DegeneratePoints& degenerate) {
  HWY_DYNAMIC_DISPATCH(Features)(in, out, degenerate);
}

}  // namespace pointsweep
#endif
