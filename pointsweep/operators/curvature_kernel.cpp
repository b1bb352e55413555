// SPDX-License-Identifier: MIT
#include "pointsweep/operators/curvature_kernel.h"

#include <algorithm>

#include "pointsweep/math/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pointsweep/operators/curvature_kernel.cpp"
#include <hwy/foreach_target.h>
// The lanes follow the inclusion of the targets.
#include "pointsweep/operators/column_lanes-inl.h"
#include "pointsweep/operators/neighborhood_lanes-inl.h"
#include "pointsweep/operators/tangent_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {

using Vector = Vec3Lanes<V>;
using Matrix = Symmetric3Lanes<V>;

/// Normals of neighbours, as unit vectors or 0, and whether there is one: 1 or 0.
class NeighborNormals {
 public:
  explicit NeighborNormals(const Tile& tile) : tile_(tile), vectors_(tile, {tile.in}) { MakeUnit(0); }
  HWY_INLINE void Hold(std::size_t from) {
    if (vectors_.Hold(from)) MakeUnit(from);
  }
  HWY_INLINE Vector Load(std::size_t vector, std::size_t c) const { return vectors_.Load(vector, c); }
  HWY_INLINE V Present(std::size_t vector, std::size_t c) const {
    return hn::Load(Lanes(), present_.of + tile_.At(vector, c));
  }

 private:
  struct NormalOf {
    const Neighborhoods& in;
    HWY_INLINE auto operator()(std::size_t) const {
      return [this](NeighborRef ref) HWY_ATTR { return in.vector_of(0, ref); };
    }
  };

  void MakeUnit(std::size_t from) {
    const Lanes d;
    for (std::size_t c = 0; c < tile_.Held(from); ++c) {
      for (std::size_t v = 0; v < tile_.vectors; ++v) {
        const Vector n = UnitOrZero(vectors_.Load(v, c));
        const auto present = hn::Gt(Dot(n, n), hn::Zero(d));
        vectors_.Store(n, v, c);
        hn::Store(hn::IfThenElseZero(present, hn::Set(d, 1.0)), d, present_.of + tile_.At(v, c));
      }
    }
  }

  const Tile& tile_;
  NeighborVectors<NormalOf> vectors_;
  NeighborArray<double> present_;
};

/// Sums over the neighbours that have a normal; over all of them in `moments`.
struct Sums {
  Scaling scaling;
  Matrix moments = ZeroMatrix();           // |N_i| M_i of Equation 1
  Matrix weighted_normals = ZeroMatrix();  // |N_i| C_i of Equation 2
  Matrix normals = ZeroMatrix(), positions = ZeroMatrix();
  Vector position{hn::Zero(Lanes()), hn::Zero(Lanes()), hn::Zero(Lanes())};
  V count = hn::Zero(Lanes());

  /// In two loops, for not all sums together fit into registers.
  HWY_INLINE void IncludeHeld(const Tile& tile, std::size_t from, std::size_t v, const Offsets& offsets,
                              const Weights& weights, const NeighborNormals& neighbors) {
    for (std::size_t c = 0; c < tile.Held(from); ++c) {
      const Vector offset = scaling.Scaled(offsets.Load(v, c)), seen = Times(neighbors.Present(v, c), offset);
      AddOuterProduct(moments, weights.Load(v, c), offset);
      AddOuterProduct(positions, seen);
      position = {hn::Add(position.x, seen.x), hn::Add(position.y, seen.y), hn::Add(position.z, seen.z)};
    }
    for (std::size_t c = 0; c < tile.Held(from); ++c) {
      const Vector n = neighbors.Load(v, c);
      AddOuterProduct(weighted_normals, weights.Load(v, c), n);
      AddOuterProduct(normals, n);
      count = hn::Add(count, neighbors.Present(v, c));
    }
  }
};

/// Covariances of the positions along two unit vectors, about their mean, times their number.
struct Covariances {
  V along, across, both;

  HWY_INLINE Covariances(const Sums& sums, const Vector& u, const Vector& v) {
    const V inverse = hn::Div(hn::Set(Lanes(), 1.0), sums.count);
    const Vector mu = Times(sums.positions, u), mv = Times(sums.positions, v);
    const V pu = Dot(sums.position, u), pv = Dot(sums.position, v), mean_v = hn::Mul(pv, inverse);
    along = hn::Sub(Dot(u, mu), hn::Mul(pu, hn::Mul(pu, inverse)));
    across = hn::Sub(Dot(v, mv), hn::Mul(pv, mean_v));
    both = hn::Sub(Dot(u, mv), hn::Mul(pu, mean_v));
  }
};

/// Curvatures of a point per lane; `found` where there are any.
struct Principal {
  V k1, k2;
  Vector direction;
  hn::Mask<Lanes> found;
};

/// `e` is that of sums.normals.
HWY_INLINE Principal PrincipalCurvatures(const Vector& n, const Sums& sums, const Eigen3Lanes<V>& e) {
  const Lanes d;
  const V zero = hn::Zero(d);
  const Vector along = Tangent(n, e.vector1, e.vector0), across = Cross(n, along);
  const Covariances covariances(sums, along, across);
  const V p1 = covariances.along, p2 = covariances.across, p12 = covariances.both, rounding = sums.scaling.rounding;
  const V spread = hn::Add(p1, p2), noise = hn::Mul(sums.count, hn::Mul(rounding, rounding));
  // The determinant over the trace is the smaller eigenvalue, to a factor of two: 0 for points on a line.
  const V determinant = hn::Sub(hn::Mul(p1, p2), hn::Mul(p12, p12));
  const V least = hn::Mul(hn::Add(hn::Mul(hn::Set(d, 1e-12), spread), noise), spread);
  const auto found =
      hn::And(hn::And(hn::Gt(Dot(n, n), zero), hn::Ge(sums.count, hn::Set(d, 3.0))), hn::Gt(determinant, least));
  const V a = hn::Sqrt(hn::Div(hn::Max(e.value1, zero), p1)), b = hn::Sqrt(hn::Div(hn::Max(e.value0, zero), p2));
  return {hn::Max(a, b), hn::Min(a, b), Choose(hn::Lt(a, b), across, along), found};
}

/// The smallest eigenvalue of m with the given trace. After `normals` n is its eigenvector, rounded to single
/// precision, and n^T m n is right to the square of that.
HWY_INLINE V SmallestEigenvalue(const Matrix& m, V trace, const Vector& n) {
  const Lanes d;
  const Vector mn = Times(m, n);
  const V quotient = Dot(n, mn);
  const Vector rest{hn::Sub(mn.x, hn::Mul(quotient, n.x)), hn::Sub(mn.y, hn::Mul(quotient, n.y)),
                    hn::Sub(mn.z, hn::Mul(quotient, n.z))};
  // The quotient is wrong by at most |rest|² over the gap to the next eigenvalue, which is at least the product of the
  // two others over their sum, less the quotient.
  const V minors = hn::Add(
      hn::Add(hn::Sub(hn::Mul(m.xx, m.yy), hn::Mul(m.xy, m.xy)), hn::Sub(hn::Mul(m.xx, m.zz), hn::Mul(m.xz, m.xz))),
      hn::Sub(hn::Mul(m.yy, m.zz), hn::Mul(m.yz, m.yz)));
  const V others = hn::Sub(trace, quotient), product = hn::Sub(minors, hn::Mul(quotient, others));
  const V gap = hn::Sub(product, hn::Mul(quotient, others));  // times `others`
  const auto right = hn::Le(hn::Mul(Dot(rest, rest), others), hn::Mul(hn::Mul(hn::Set(d, 1e-13), trace), gap));
  if (hn::AllTrue(d, right)) return quotient;
  return hn::IfThenElse(right, quotient, EigenSymmetric3(d, m)[0].value0);
}

/// Inline, so that eigenvectors nobody looks at are not computed. Returns the number of points without curvatures.
HWY_INLINE std::size_t StoreCurvatures(const Principal& p, const Sums& sums, const Vector& normal,
                                       const Eigen3Lanes<V>& weighted_normals, V nearest_theta, V neighbors,
                                       const Points& points, const CurvatureColumns& out) {
  const Lanes d;
  const V zero = hn::Zero(d), half = hn::Set(d, 0.5), most = hn::Set(d, 1e150);  // so that a product is a number
  const auto curvature = [&](V v) HWY_ATTR {
    return hn::IfThenElseZero(p.found, hn::Min(hn::Mul(v, sums.scaling.scale), most));
  };
  const V k1 = curvature(p.k1), k2 = curvature(p.k2), sum = hn::Add(k1, k2);
  StoreNumbers(k1, points, out.k1);
  StoreNumbers(k2, points, out.k2);
  StoreDirections(p.found, p.direction, points, out.direction);
  StoreNumbers(hn::Mul(sum, half), points, out.mean);
  StoreNumbers(hn::Mul(k1, k2), points, out.gaussian);
  StoreNumbers(hn::Sqrt(hn::Mul(hn::Add(hn::Mul(k1, k1), hn::Mul(k2, k2)), half)), points, out.rms);
  StoreNumbers(sum, points, out.absolute);

  const V trace = hn::Add(hn::Add(sums.moments.xx, sums.moments.yy), sums.moments.zz);
  const V variation = hn::Div(hn::Max(SmallestEigenvalue(sums.moments, trace, normal), zero), trace);
  StoreNumbers(hn::IfThenElseZero(hn::And(p.found, hn::Gt(trace, zero)), variation), points, out.surface_variation);
  const V share = hn::Div(nearest_theta, hn::Max(neighbors, hn::Set(d, 1.0)));
  const auto eigenvalue = [&](V v) HWY_ATTR {
    return Saturated(hn::IfThenElseZero(p.found, hn::Mul(hn::Max(v, zero), share)));
  };
  StoreTriples(eigenvalue(weighted_normals.value0), eigenvalue(weighted_normals.value1),
               eigenvalue(weighted_normals.value2), points, out.normal_eigenvalues);
  return points.CountWithout(p.found);
}

std::size_t Curvatures(const Neighborhoods& in, const CurvatureColumns& out) {
  std::size_t degenerate = 0;
  for (std::size_t first = 0; first < in.size();) {
    Tile tile(in, first, in.size());
    Offsets offsets(tile, {in});
    const Extents extents(tile, offsets);
    Weights weights(tile, extents, offsets);
    NeighborNormals neighbors(tile);
    const OwnVectors own(tile, 0);
    for (std::size_t v = 0; v < tile.vectors; ++v) {
      Sums sums{Scaling(extents, v)};
      for (std::size_t from = 0; from < tile.most; from += tile.chunk) {
        weights.Hold(from);
        neighbors.Hold(from);
        sums.IncludeHeld(tile, from, v, offsets, weights, neighbors);
      }
      const Vector normal = UnitOrZero(own.Load(v));
      const auto e = EigenSymmetric3(Lanes(), sums.normals, sums.weighted_normals);
      degenerate += StoreCurvatures(PrincipalCurvatures(normal, sums, e[0]), sums, normal, e[1],
                                    weights.NearestTheta(v), extents.count.Load(v), Points(tile, v), out);
    }
    first += tile.size;
  }
  return degenerate;
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointsweep {

HWY_EXPORT(Curvatures);

std::size_t curvatures(const Neighborhoods& in, const CurvatureColumns& out) {
  return HWY_DYNAMIC_DISPATCH(Curvatures)(in, out);
}

}  // namespace pointsweep
#endif
