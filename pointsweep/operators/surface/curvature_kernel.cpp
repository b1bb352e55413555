// SPDX-License-Identifier: MIT
#include <cstddef>
#include <optional>

#include "pointsweep/math/instruction_sets.h"
#include "pointsweep/operators/surface/curvature.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pointsweep/operators/surface/curvature_kernel.cpp"
#include <hwy/foreach_target.h>
// The lanes must be included after foreach_target.h, which includes this file for each instruction set.
#include "pointsweep/operators/lanes/column_lanes-inl.h"
#include "pointsweep/operators/lanes/neighborhood_lanes-inl.h"
#include "pointsweep/operators/lanes/tangent_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {

using Vector = Vec3Lanes<V>;
using Matrix = Symmetric3Lanes<V>;

/// The normals of the neighbours that a tile holds, as unit vectors, with a number for each: 1 if the neighbour has a
/// normal; else the vector and the number are 0.
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
        const Direction<V> n = DirectionOf(vectors_.Load(v, c));
        vectors_.Store(n.unit, v, c);
        hn::Store(hn::IfThenElseZero(n.exists, hn::Set(d, 1.0)), d, present_.of + tile_.At(v, c));
      }
    }
  }

  const Tile& tile_;
  NeighborVectors<NormalOf> vectors_;
  NeighborArray<double> present_;
};

/// The sums of Equations 1 and 2.
struct WeightedSums {
  Matrix moments = ZeroMatrix();  // |N_i| M_i times scale² (Scaling), over θ of the nearest neighbour (Weighting)
  Matrix normals = ZeroMatrix();  // |N_i| C_i over Weights::Divisor()
};

/// Sums over the neighbours that have a normal, with equal weights: unit normals n n^T, scaled offsets o o^T and o, and
/// their number.
struct Sums {
  Scaling scaling;
  Matrix normals = ZeroMatrix(), positions = ZeroMatrix();
  Vector position{hn::Zero(Lanes()), hn::Zero(Lanes()), hn::Zero(Lanes())};
  V count = hn::Zero(Lanes());
};

/// The sums of Sums, and the weighted sums if they are wanted.
template <bool kWeighted>
struct AllSums : Sums {
  WeightedSums weighted = {};

  /// Adds the neighbours of the points of vector `v` that the tile holds, in two loops, since all sums together do not
  /// fit in registers.
  HWY_INLINE void IncludeHeld(const Tile& tile, std::size_t from, std::size_t v, const Offsets& offsets,
                              const Weights* weights, const NeighborNormals& neighbors) {
    for (std::size_t c = 0; c < tile.Held(from); ++c) {
      const Vector offset = scaling.Scaled(offsets.Load(v, c)), seen = Times(neighbors.Present(v, c), offset);
      if constexpr (kWeighted) AddOuterProduct(weighted.moments, weights->Load(v, c), offset);
      AddOuterProduct(positions, seen);
      position = Plus(position, seen);
    }
    for (std::size_t c = 0; c < tile.Held(from); ++c) {
      const Vector n = neighbors.Load(v, c);
      if constexpr (kWeighted) AddOuterProduct(weighted.normals, weights->LoadTrue(v, c), n);
      AddOuterProduct(normals, n);
      count = hn::Add(count, neighbors.Present(v, c));
    }
  }
};

/// Variances of the scaled positions along the unit vectors u (`along`) and v (`across`), and the covariance of both,
/// about the mean position; all times the number of positions.
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

/// Curvatures of the scaled positions, a point per lane. `found` is true for points that have curvatures.
struct Principal {
  V k1, k2;
  Vector direction;
  hn::Mask<Lanes> found;
};

/// Returns the principal curvatures. `e`: eigenvalues and eigenvectors of sums.normals.
HWY_INLINE Principal PrincipalCurvatures(const Vector& n, const Sums& sums, const Eigen3Lanes<V>& e) {
  const Lanes d;
  const V zero = hn::Zero(d);
  const Vector along = Tangent(n, e.vector1, e.vector0), across = Cross(n, along);
  const Covariances covariances(sums, along, across);
  const V p1 = covariances.along, p2 = covariances.across, p12 = covariances.both, rounding = sums.scaling.rounding;
  const V spread = hn::Add(p1, p2), noise = hn::Mul(sums.count, hn::Mul(rounding, rounding));
  // The determinant over the trace is the smaller eigenvalue, to a factor of two; it is 0 for points on a line.
  const V determinant = hn::Sub(hn::Mul(p1, p2), hn::Mul(p12, p12));
  const V least = hn::Mul(hn::Add(hn::Mul(hn::Set(d, 1e-12), spread), noise), spread);
  const auto found =
      hn::And(hn::And(hn::Gt(Dot(n, n), zero), hn::Ge(sums.count, hn::Set(d, 3.0))), hn::Gt(determinant, least));
  const V a = hn::Sqrt(hn::Div(hn::Max(e.value1, zero), p1)), b = hn::Sqrt(hn::Div(hn::Max(e.value0, zero), p2));
  return {hn::Max(a, b), hn::Min(a, b), Choose(hn::Lt(a, b), across, along), found};
}

/// Returns the smallest eigenvalue of m, whose trace is `trace`. If n is the eigenvector of this eigenvalue, rounded to
/// single precision as by `normals`, the result is n^T m n, whose error is of the order of the square of that rounding.
/// For any other unit vector n, such as a normal of the input, the eigenvalue is computed from m alone.
HWY_INLINE V SmallestEigenvalue(const Matrix& m, V trace, const Vector& n) {
  const Lanes d;
  const Vector mn = Times(m, n);
  const V quotient = Dot(n, mn);
  const Vector rest = Minus(mn, Times(quotient, n));
  // The error of the quotient is at most |rest|² over the gap between the quotient and the next eigenvalue. The next
  // eigenvalue is at least the product of the two larger eigenvalues over their sum.
  const V minors = hn::Add(
      hn::Add(hn::Sub(hn::Mul(m.xx, m.yy), hn::Mul(m.xy, m.xy)), hn::Sub(hn::Mul(m.xx, m.zz), hn::Mul(m.xz, m.xz))),
      hn::Sub(hn::Mul(m.yy, m.zz), hn::Mul(m.yz, m.yz)));
  const V others = hn::Sub(trace, quotient), product = hn::Sub(minors, hn::Mul(quotient, others));
  const V gap = hn::Sub(product, hn::Mul(quotient, others));  // a lower bound of the gap, times `others`
  const auto right = hn::Le(hn::Mul(Dot(rest, rest), others), hn::Mul(hn::Mul(hn::Set(d, 1e-13), trace), gap));
  if (hn::AllTrue(d, right)) return quotient;
  return hn::IfThenElse(right, quotient, EigenSymmetric3(d, m)[0].value0);
}

/// Stores the curvatures, and marks the points without curvatures as degenerate.
HWY_INLINE void StorePrincipal(const Principal& p, V scale, const Points& points, const CurvatureColumns& out,
                               DegeneratePoints& degenerate) {
  const Lanes d;
  const V half = hn::Set(d, 0.5), most = hn::Set(d, 1e150);  // small enough that a product does not overflow
  const auto curvature = [&](V v) HWY_ATTR { return hn::IfThenElseZero(p.found, hn::Min(hn::Mul(v, scale), most)); };
  const V k1 = curvature(p.k1), k2 = curvature(p.k2), sum = hn::Add(k1, k2);
  StoreNumbers(k1, points, out.k1);
  StoreNumbers(k2, points, out.k2);
  StoreDirections(p.found, p.direction, points, out.direction);
  StoreNumbers(hn::Mul(sum, half), points, out.mean);
  StoreNumbers(hn::Mul(k1, k2), points, out.gaussian);
  StoreNumbers(hn::Sqrt(hn::Mul(hn::Add(hn::Mul(k1, k1), hn::Mul(k2, k2)), half)), points, out.rms);
  StoreNumbers(sum, points, out.absolute);
  points.MarkWithout(p.found, degenerate);
}

/// Stores the surface variation and the eigenvalues of C_i. `eigen_normals`: eigenvalues and eigenvectors of
/// sums.normals. `divisor`: Weights::Divisor(). `neighbors`: |N_i|. Inline, so that unused eigenvectors are not
/// computed.
template <class Mask>
HWY_INLINE void StoreWeighted(Mask found, const WeightedSums& sums, const Eigen3Lanes<V>& eigen_normals,
                              const Vector& normal, V divisor, V neighbors, const Points& points,
                              const CurvatureColumns& out) {
  const Lanes d;
  const V zero = hn::Zero(d), trace = hn::Add(hn::Add(sums.moments.xx, sums.moments.yy), sums.moments.zz);
  const V variation = hn::Div(hn::Max(SmallestEigenvalue(sums.moments, trace, normal), zero), trace);
  StoreNumbers(hn::IfThenElseZero(hn::And(found, hn::Gt(trace, zero)), variation), points, out.surface_variation);
  const V share = hn::Div(divisor, hn::Max(neighbors, hn::Set(d, 1.0)));
  const auto eigenvalue = [&](V v) HWY_ATTR {
    return Saturated(hn::IfThenElseZero(found, hn::Mul(hn::Max(v, zero), share)));
  };
  StoreTriples(eigenvalue(eigen_normals.value0), eigenvalue(eigen_normals.value1), eigenvalue(eigen_normals.value2),
               points, out.normal_eigenvalues);
}

/// The points of a tile, and all values needed for their curvatures.
template <bool kWeighted>
class CurvatureTile {
 public:
  CurvatureTile(Tile& tile, const CurvatureColumns& out, DegeneratePoints& degenerate)
      : tile_(tile),
        out_(out),
        degenerate_(degenerate),
        offsets_(tile, {tile.in}),
        extents_(tile, offsets_),
        neighbors_(tile) {
    if constexpr (kWeighted) weights_.emplace(tile, extents_, offsets_);
  }

  /// Computes and stores the results of all points. Solves two eigenproblems at a time: those of S and C_i of one
  /// vector of points if θ is wanted, else those of S of two vectors.
  HWY_INLINE void Store() {
    const Lanes d;
    for (std::size_t v = 0; v < tile_.vectors; v += kWeighted ? 1 : 2) {
      const auto a = SumsOf(v);
      if constexpr (kWeighted) {
        const auto e = EigenSymmetric3(d, a.normals, a.weighted.normals);
        StoreOne(v, a, e[0], &e[1]);
      } else {
        const auto b = v + 1 < tile_.vectors ? SumsOf(v + 1) : a;
        const auto e = EigenSymmetric3(d, a.normals, b.normals);
        StoreOne(v, a, e[0], nullptr);
        if (v + 1 < tile_.vectors) StoreOne(v + 1, b, e[1], nullptr);
      }
    }
  }

 private:
  HWY_INLINE AllSums<kWeighted> SumsOf(std::size_t v) {
    AllSums<kWeighted> sums{{Scaling(extents_, v)}};
    for (std::size_t from = 0; from < tile_.most; from += tile_.chunk) {
      if constexpr (kWeighted) weights_->Hold(from);
      offsets_.Hold(from);
      neighbors_.Hold(from);
      sums.IncludeHeld(tile_, from, v, offsets_, kWeighted ? &*weights_ : nullptr, neighbors_);
    }
    return sums;
  }

  HWY_INLINE void StoreOne(std::size_t v, const AllSums<kWeighted>& sums, const Eigen3Lanes<V>& of_normals,
                           const Eigen3Lanes<V>* of_weighted_normals) const {
    const Points points(tile_, v);
    const Vector normal = UnitOrZero(OwnVectors(tile_, 0, v));
    const Principal principal = PrincipalCurvatures(normal, sums, of_normals);
    if constexpr (kWeighted)
      StoreWeighted(principal.found, sums.weighted, *of_weighted_normals, normal, weights_->Divisor(v),
                    extents_.count.Load(v), points, out_);
    StorePrincipal(principal, sums.scaling.scale, points, out_, degenerate_);
  }

  const Tile& tile_;
  const CurvatureColumns& out_;
  DegeneratePoints& degenerate_;
  Offsets offsets_;
  const Extents extents_;
  std::optional<Weights> weights_;
  NeighborNormals neighbors_;
};

void Curvatures(const Neighborhoods& in, const CurvatureColumns& out, DegeneratePoints& degenerate) {
  for (std::size_t first = 0; first < in.size();) {
    Tile tile(in, first, in.size());
    out.weighted() ? CurvatureTile<true>(tile, out, degenerate).Store()
                   : CurvatureTile<false>(tile, out, degenerate).Store();
    first += tile.size;
  }
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointsweep {

HWY_EXPORT(Curvatures);

void curvatures(const Neighborhoods& in, const CurvatureColumns& out, DegeneratePoints& degenerate) {
  HWY_DYNAMIC_DISPATCH(Curvatures)(in, out, degenerate);
}

}  // namespace pointsweep
#endif
