// SPDX-License-Identifier: MIT
#include "pointsweep/operators/splats_kernel.h"

#include <algorithm>
#include <limits>

#include "pointsweep/math/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pointsweep/operators/splats_kernel.cpp"
#include <hwy/foreach_target.h>
// The lanes follow the inclusion of the targets.
#include "pointsweep/operators/neighborhood_lanes-inl.h"
#include "pointsweep/operators/tangent_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {

constexpr std::size_t kHeld = 8;         // neighbours inside a splat
constexpr double kThinnest = 1.0 / 8.0;  // least ratio

using Vector = Vec3Lanes<V>;

/// Shape of an ellipse without its size, a point per lane.
struct Ellipse {
  Vector major, minor;  // unit, in the tangent plane
  V ratio;

  Ellipse(const Vector& normal, const Vector& axis, V flatness) : major(axis), minor(Cross(normal, axis)) {
    ratio = hn::Min(hn::Max(flatness, hn::Set(Lanes(), kThinnest)), hn::Set(Lanes(), 1.0));
  }
  /// Square of the major semi-axis of the ellipse through p_i + offset, projected into its plane.
  HWY_INLINE V Reach2(const Vector& offset) const {
    const V along = Dot(offset, major), across = hn::Div(Dot(offset, minor), ratio);
    return hn::Add(hn::Mul(along, along), hn::Mul(across, across));
  }
};

/// The eight least of what each lane is shown, ascending.
struct Least {
  V least[kHeld], seen;

  Least() : seen(hn::Zero(Lanes())) {
    for (V& v : least) v = hn::Set(Lanes(), std::numeric_limits<double>::infinity());
  }
  /// Only what is greater than 0 counts.
  HWY_INLINE void Show(V value) {
    const Lanes d;
    const auto counts = hn::Gt(value, hn::Zero(d));
    V carried = hn::IfThenElse(counts, value, hn::Set(d, std::numeric_limits<double>::infinity()));
    seen = hn::Add(seen, hn::IfThenElseZero(counts, hn::Set(d, 1.0)));
    for (V& v : least) {
      const V smaller = hn::Min(v, carried);
      carried = hn::Max(v, carried);
      v = smaller;
    }
  }
  V Held() const { return hn::Min(seen, hn::Set(Lanes(), double(kHeld))); }
  /// The greatest of those held.
  V Last() const {
    V last = least[0];
    for (std::size_t i = 1; i < kHeld; ++i)
      last = hn::IfThenElse(hn::Gt(seen, hn::Set(Lanes(), double(i))), least[i], last);
    return last;
  }
};

/// Of the eigenvectors of M_i.
HWY_INLINE Ellipse EllipseOfPositions(const Neighborhoods& in, std::size_t first, const Extents& extents,
                                      const Weighting& weighting, const Vector& normal) {
  const Lanes d;
  Symmetric3Lanes<V> moments = ZeroMatrix();
  ForNeighbors(in, first, extents, weighting.scale, [&](const Vector& offset, std::size_t j) HWY_ATTR {
    AddOuterProduct(moments, weighting.Theta(offset, j), offset);
  });
  const Eigen3Lanes<V> e = EigenSymmetric3(d, moments)[0];
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0);
  const V flatness = hn::Sqrt(hn::Div(hn::Max(e.value1, zero), e.value2));
  return {normal, Tangent(normal, e.vector2, e.vector1), hn::IfThenElse(hn::Gt(e.value2, zero), flatness, one)};
}

/// The direction of least curvature, where `found`.
struct Ridge {
  Vector axis;
  V flatness;
  hn::Mask<Lanes> found;

  Ridge(const Neighborhoods& in, std::size_t first, const Vector& normal) {
    const auto own = [&](std::size_t a) HWY_ATTR {
      return OwnNumbers(in, first, [&](std::size_t i) HWY_ATTR { return double(in.value<float>(a, i)); });
    };
    const V zero = hn::Zero(Lanes()), k1 = own(2), k2 = own(3);
    axis = UnitOrZero(Cross(normal, UnitOrZero(OwnVectors(in, first, 1))));
    flatness = hn::Sqrt(hn::Div(k2, k1));
    found = hn::And(hn::Gt(Dot(axis, axis), zero), hn::And(hn::Gt(k1, zero), hn::Ge(k2, zero)));
  }
};

/// Along the ridge where there is one.
HWY_INLINE Ellipse EllipseOfCurvature(const Neighborhoods& in, std::size_t first, const Extents& extents,
                                      const Weighting& weighting, const Vector& normal) {
  const Ridge ridge(in, first, normal);
  if (hn::AllTrue(Lanes(), ridge.found)) return {normal, ridge.axis, ridge.flatness};
  const Ellipse otherwise = EllipseOfPositions(in, first, extents, weighting, normal);
  return {normal, Choose(ridge.found, ridge.axis, otherwise.major),
          hn::IfThenElse(ridge.found, ridge.flatness, otherwise.ratio)};
}

void StoreSplats(const Ellipse& ellipse, V length, std::span<PointSplat> out) {
  const Lanes d;
  LaneArray lanes[5];
  const V values[5] = {ellipse.major.x, ellipse.major.y, ellipse.major.z, length, ellipse.ratio};
  for (std::size_t i = 0; i < 5; ++i) hn::Store(values[i], d, lanes[i].of);
  for (std::size_t l = 0; l < std::min(kLanes, out.size()); ++l) {
    out[l] = {};
    if (lanes[3].of[l] > 0) out[l] = {{lanes[0].of[l], lanes[1].of[l], lanes[2].of[l]}, lanes[3].of[l], lanes[4].of[l]};
  }
}

void FitSplats(const Neighborhoods& in, std::size_t first, bool along_ridges, std::span<PointSplat> out) {
  const Lanes d;
  for (std::size_t from = 0; from < out.size(); from += kLanes) {
    const std::size_t at = first + from;
    const Extents extents(in, at);
    const Weighting weighting(extents);
    const Vector normal = UnitOrZero(OwnVectors(in, at, 0));
    const Ellipse ellipse = along_ridges ? EllipseOfCurvature(in, at, extents, weighting, normal)
                                         : EllipseOfPositions(in, at, extents, weighting, normal);
    Least least;
    ForNeighbors(in, at, extents, weighting.scale,
                 [&](const Vector& offset, std::size_t) HWY_ATTR { least.Show(ellipse.Reach2(offset)); });
    const V held = least.Held();
    const V fitted = hn::Sqrt(hn::Mul(least.Last(), hn::Div(hn::Set(d, double(kHeld)), held)));
    const auto found = hn::And(hn::Gt(held, hn::Zero(d)), hn::Gt(Dot(normal, normal), hn::Zero(d)));
    const V unscale = PowerOfTwoBelow(d, extents.largest.Load());
    StoreSplats(ellipse, hn::IfThenElseZero(found, hn::Mul(fitted, unscale)), out.subspan(from));
  }
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointsweep {

HWY_EXPORT(FitSplats);

void fit_splats(const Neighborhoods& in, std::size_t first, bool along_ridges, std::span<PointSplat> out) {
  HWY_DYNAMIC_DISPATCH(FitSplats)(in, first, along_ridges, out);
}

}  // namespace pointsweep
#endif
