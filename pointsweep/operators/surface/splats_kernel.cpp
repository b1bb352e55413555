// SPDX-License-Identifier: MIT
#include <cstddef>
#include <limits>

#include "pointsweep/math/instruction_sets.h"
#include "pointsweep/operators/surface/splats.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pointsweep/operators/surface/splats_kernel.cpp"
#include <hwy/foreach_target.h>
// The lanes must be included after foreach_target.h, which includes this file for each instruction set.
#include "pointsweep/operators/lanes/column_lanes-inl.h"
#include "pointsweep/operators/lanes/neighborhood_lanes-inl.h"
#include "pointsweep/operators/lanes/tangent_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {

constexpr std::size_t kHeld = 8;         // neighbours inside a splat
constexpr double kThinnest = 1.0 / 8.0;  // least ratio

using Vector = Vec3Lanes<V>;

/// Shape of an ellipse without its size, a point per lane.
struct Ellipse {
  Vector major;  // unit vector in the tangent plane
  V ratio;
};

Ellipse MakeEllipse(const Vector& axis, V flatness) {
  return {axis, hn::Min(hn::Max(flatness, hn::Set(Lanes(), kThinnest)), hn::Set(Lanes(), 1.0))};
}

/// Returns the ellipse from the eigenvalues and eigenvectors of M_i.
HWY_INLINE Ellipse EllipseOfPositions(const Moments& moments, const Vector& normal) {
  const Lanes d;
  const Eigen3Lanes<V> e = EigenSymmetric3(d, moments.m)[0];
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0);
  const V flatness = hn::Sqrt(hn::Div(hn::Max(e.value1, zero), e.value2));
  return MakeEllipse(Tangent(normal, e.vector2, e.vector1), hn::IfThenElse(hn::Gt(e.value2, zero), flatness, one));
}

/// Returns an ellipse along the direction of least curvature if the point has curvatures, else along the eigenvectors
/// of M_i.
HWY_INLINE Ellipse EllipseOfCurvature(const Tile& tile, const Extents& extents, const Offsets& offsets,
                                      Weights& weights, std::size_t v, const Vector& normal) {
  const V zero = hn::Zero(Lanes()), k1 = OwnNumbers(tile, 2, v), k2 = OwnNumbers(tile, 3, v);
  const Vector axis = UnitOrZero(Cross(normal, UnitOrZero(OwnVectors(tile, 1, v))));
  const Ellipse ridge = MakeEllipse(axis, hn::Sqrt(hn::Div(k2, k1)));
  const auto found = hn::And(hn::Gt(Dot(axis, axis), zero), hn::And(hn::Gt(k1, zero), hn::Ge(k2, zero)));
  if (hn::AllTrue(Lanes(), found)) return ridge;
  const Ellipse otherwise = EllipseOfPositions(SumMoments(tile, extents, offsets, weights, v), normal);
  return {Choose(found, ridge.major, otherwise.major), hn::IfThenElse(found, ridge.ratio, otherwise.ratio)};
}

/// Computes reaches of neighbours and counts them (`seen`). A reach is the square of the major semi-axis of the ellipse
/// through the projection of a neighbour onto the tangent plane, with offsets times `scale`. Only neighbours with a
/// reach greater than 0 count.
struct Reaches {
  V scale;
  Vector major, across;  // across: unit vector along the minor axis, divided by the ratio
  V seen = hn::Zero(Lanes());

  Reaches(const Ellipse& ellipse, const Vector& normal, V power)
      : scale(power),
        major(ellipse.major),
        across(Times(hn::Div(hn::Set(Lanes(), 1.0), ellipse.ratio), Cross(normal, ellipse.major))) {}

  /// Returns the reach of the next neighbour; `otherwise` if the neighbour does not count.
  HWY_INLINE V Next(const Vector& raw, V otherwise) {
    const Lanes d;
    const Vector offset = Times(scale, raw);
    const V a = Dot(offset, major), b = Dot(offset, across);
    const V reach2 = hn::Add(hn::Mul(a, a), hn::Mul(b, b));
    const auto counts = hn::Gt(reach2, hn::Zero(d));
    seen = hn::Add(seen, hn::IfThenElseZero(counts, hn::Set(d, 1.0)));
    return hn::IfThenElse(counts, reach2, otherwise);
  }
  V Held() const { return hn::Min(seen, hn::Set(Lanes(), double(kHeld))); }
};

/// Keeps the greatest reach, for points with at most eight neighbours.
struct Greatest : Reaches {
  V greatest;

  Greatest(const Ellipse& ellipse, const Vector& normal, V power) : Reaches(ellipse, normal, power) {
    greatest = hn::Zero(Lanes());
  }
  HWY_INLINE void Include(const Vector& raw) { greatest = hn::Max(greatest, Next(raw, hn::Zero(Lanes()))); }
  V Last() const { return greatest; }
};

/// Keeps the eight least reaches, ascending.
struct Least : Reaches {
  V least[kHeld];

  Least(const Ellipse& ellipse, const Vector& normal, V power) : Reaches(ellipse, normal, power) {
    for (V& v : least) v = hn::Set(Lanes(), std::numeric_limits<double>::infinity());
  }
  HWY_INLINE void Include(const Vector& raw) {
    V carried = Next(raw, hn::Set(Lanes(), std::numeric_limits<double>::infinity()));
    for (V& v : least) {
      const V smaller = hn::Min(v, carried);
      carried = hn::Max(v, carried);
      v = smaller;
    }
  }
  /// Returns the greatest of the reaches kept; infinity if no neighbour counts.
  V Last() const {
    V last = least[0];
    for (std::size_t i = 1; i < kHeld; ++i)
      last = hn::IfThenElse(hn::Gt(seen, hn::Set(Lanes(), double(i))), least[i], last);
    return last;
  }
};

/// Stores the splats, and marks the points without a splat as degenerate.
HWY_INLINE void StoreSplats(const Ellipse& ellipse, V length, const Points& points, const SplatColumns& out,
                            DegeneratePoints& degenerate) {
  const auto found = hn::Gt(length, hn::Zero(Lanes()));
  StoreDirections(found, ellipse.major, points, out.axis);
  StoreNumbers(hn::IfThenElseZero(found, length), points, out.length);
  StoreNumbers(hn::IfThenElseZero(found, ellipse.ratio), points, out.ratio);
  points.MarkWithout(found, degenerate);
}

/// Stores the ellipses of a vector of points, in the size at which an ellipse holds kHeld neighbours; with m < kHeld
/// neighbours that count, √(kHeld / m) times the size at which it holds all of them.
template <class Kept>
HWY_INLINE void StoreFitted(const Tile& tile, const Extents& extents, Offsets& offsets, std::size_t v,
                            const Ellipse& ellipse, const Vector& normal, const SplatColumns& out,
                            DegeneratePoints& degenerate) {
  const Lanes d;
  const V power = PowerOfTwoBelow(d, extents.largest.Load(v));
  Kept kept(ellipse, normal, ReciprocalOfPower(d, power));
  ForNeighbors(tile, offsets, v, kept);
  const V held = kept.Held();
  const V fitted = hn::Sqrt(hn::Mul(kept.Last(), hn::Div(hn::Set(d, double(kHeld)), held)));
  const auto found = hn::And(hn::Gt(held, hn::Zero(d)), hn::Gt(Dot(normal, normal), hn::Zero(d)));
  StoreSplats(ellipse, hn::IfThenElseZero(found, hn::Mul(fitted, power)), Points(tile, v), out, degenerate);
}

void FitSplats(const Neighborhoods& in, bool along_ridges, const SplatColumns& out, DegeneratePoints& degenerate) {
  for (std::size_t first = 0; first < in.size();) {
    Tile tile(in, first, in.size());
    Offsets offsets(tile, {in});
    const Extents extents(tile, offsets);
    Weights weights(tile, extents, offsets);
    for (std::size_t v = 0; v < tile.vectors; ++v) {
      const Vector normal = UnitOrZero(OwnVectors(tile, 0, v));
      const Ellipse ellipse = along_ridges ? EllipseOfCurvature(tile, extents, offsets, weights, v, normal)
                                           : EllipseOfPositions(SumMoments(tile, extents, offsets, weights, v), normal);
      tile.most <= kHeld ? StoreFitted<Greatest>(tile, extents, offsets, v, ellipse, normal, out, degenerate)
                         : StoreFitted<Least>(tile, extents, offsets, v, ellipse, normal, out, degenerate);
    }
    first += tile.size;
  }
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointsweep {

HWY_EXPORT(FitSplats);

void fit_splats(const Neighborhoods& in, bool along_ridges, const SplatColumns& out, DegeneratePoints& degenerate) {
  HWY_DYNAMIC_DISPATCH(FitSplats)(in, along_ridges, out, degenerate);
}

}  // namespace pointsweep
#endif
