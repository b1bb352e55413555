// SPDX-License-Identifier: MIT
#include "pointsweep/operators/normals_kernel.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "pointsweep/math/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pointsweep/operators/normals_kernel.cpp"
#include <hwy/foreach_target.h>
// The lanes follow the inclusion of the targets.
#include "pointsweep/math/eigen3_lanes-inl.h"
#include "pointsweep/math/exp_lanes-inl.h"

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
  LaneArray count;    // |N_i|, 0 where no normal can be
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
    if (k >= 2) {
      p = in.position(i);
      last = in.offset(i, k - 1);
      extent = std::max({std::abs(last.x), std::abs(last.y), std::abs(last.z)});
      std::size_t j = 0;
      while (j + 1 < k && in.offset(i, j) == Vec3{}) ++j;
      nearest = in.offset(i, j);
    }
    // Power-of-two scaling needs a normal number with a normal reciprocal.
    if (k < 2 || !(extent >= std::numeric_limits<double>::min() && extent < 0x1p1022)) {
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

/// Offsets p_j - p_i of a few successive neighbours, transposed: a point per lane, 0 behind a point's last neighbour.
struct OffsetChunk {
  HWY_ALIGN double x[kChunk][kLanes], y[kChunk][kLanes], z[kChunk][kLanes];

  void Fetch(const Neighborhoods& in, std::size_t first, const Extents& extents, std::size_t from) {
    for (std::size_t l = 0; l < kLanes; ++l) {
      const std::size_t k = std::size_t(extents.count.of[l]);
      const std::size_t have = std::min(kChunk, k - std::min(from, k));
      for (std::size_t c = 0; c < have; ++c) {
        const Vec3 o = in.offset(first + l, from + c);
        x[c][l] = o.x, y[c][l] = o.y, z[c][l] = o.z;
      }
      for (std::size_t c = have; c < kChunk; ++c) x[c][l] = y[c][l] = z[c][l] = 0;
    }
  }
};

HWY_INLINE V Length2(V x, V y, V z) { return hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)); }

/// Σ_j o o^T θ of Equation 1, and what λ1 must exceed besides its share of λ2.
struct Moments {
  Symmetric3Lanes<V> m;
  V noise;
};

/// Two factors that no eigenvector feels are taken out: offsets are scaled by the power of two that brings the largest
/// to about 1, so that no extent of a cloud under- or overflows, and θ by θ of the nearest neighbour, so that θ does
/// not vanish for every one of many thousand neighbours. 1/|N_i| is left out likewise.
HWY_INLINE Moments SumMoments(const Neighborhoods& in, std::size_t first) {
  const Lanes d;
  const Extents extents(in, first);
  const V scale = ReciprocalOfPower(d, PowerOfTwoBelow(d, extents.largest.Load()));
  const auto scaled = [&](const LaneArray& a) HWY_ATTR { return hn::Mul(a.Load(), scale); };
  const V count = extents.count.Load();
  const V zero = hn::Zero(d);
  const V far2 = Length2(scaled(extents.far[0]), scaled(extents.far[1]), scaled(extents.far[2]));
  const V near2 = Length2(scaled(extents.near[0]), scaled(extents.near[1]), scaled(extents.near[2]));
  const V falloff = hn::Div(hn::Mul(count, hn::Set(d, 0.5 / std::numbers::pi)), far2);  // 1 / 2σ²

  V xx = zero, xy = zero, xz = zero, yy = zero, yz = zero, zz = zero, weights = zero;
  OffsetChunk chunk;
  for (std::size_t from = 0; from < extents.most; from += kChunk) {
    chunk.Fetch(in, first, extents, from);
    for (std::size_t c = 0; c < std::min(kChunk, extents.most - from); ++c) {
      const V x = hn::Mul(hn::Load(d, chunk.x[c]), scale);
      const V y = hn::Mul(hn::Load(d, chunk.y[c]), scale);
      const V z = hn::Mul(hn::Load(d, chunk.z[c]), scale);
      const V beyond = hn::Max(hn::Sub(Length2(x, y, z), near2), zero);
      const V theta =
          hn::IfThenElseZero(hn::Lt(hn::Set(d, double(from + c)), count), ExpNegative(d, hn::Mul(beyond, falloff)));
      const V tx = hn::Mul(theta, x), ty = hn::Mul(theta, y), tz = hn::Mul(theta, z);
      xx = hn::Add(xx, hn::Mul(tx, x));
      xy = hn::Add(xy, hn::Mul(tx, y));
      xz = hn::Add(xz, hn::Mul(tx, z));
      yy = hn::Add(yy, hn::Mul(ty, y));
      yz = hn::Add(yz, hn::Mul(ty, z));
      zz = hn::Add(zz, hn::Mul(tz, z));
      weights = hn::Add(weights, theta);
    }
  }
  // A component of an offset is wrong by at most 2^-52 of the coordinate: half an ulp of p_i and half an ulp of p_j.
  const V rounding = hn::Mul(scaled(extents.place), hn::Set(d, 0x1p-51));
  return {{xx, xy, xz, yy, yz, zz}, hn::Mul(weights, hn::Mul(rounding, rounding))};
}

HWY_INLINE void StoreNormals(const Moments& moments, const Eigen3Lanes<V>& e, std::span<std::array<float, 3>> normals,
                             std::size_t first) {
  const Lanes d;
  const auto plane = hn::Gt(e.value1, hn::Add(hn::Mul(hn::Set(d, 1e-12), e.value2), moments.noise));
  LaneArray x, y, z;
  hn::Store(hn::IfThenElseZero(plane, e.vector0.x), d, x.of);
  hn::Store(hn::IfThenElseZero(plane, e.vector0.y), d, y.of);
  hn::Store(hn::IfThenElseZero(plane, e.vector0.z), d, z.of);
  for (std::size_t l = 0; l < kLanes && first + l < normals.size(); ++l)
    normals[first + l] = {float(x.of[l]), float(y.of[l]), float(z.of[l])};
}

void UnorientedNormals(const Neighborhoods& in, std::span<std::array<float, 3>> normals) {
  for (std::size_t first = 0; first < in.size(); first += 2 * kLanes) {
    const Moments a = SumMoments(in, first), b = SumMoments(in, first + kLanes);
    const auto eigen = EigenSymmetric3(Lanes(), a.m, b.m);
    StoreNormals(a, eigen[0], normals, first);
    StoreNormals(b, eigen[1], normals, first + kLanes);
  }
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointsweep {

HWY_EXPORT(UnorientedNormals);

void unoriented_normals(const Neighborhoods& in, std::span<std::array<float, 3>> normals) {
  HWY_DYNAMIC_DISPATCH(UnorientedNormals)(in, normals);
}

}  // namespace pointsweep
#endif
