// SPDX-License-Identifier: MIT
#include "pointsweep/operators/graph/orientation_votes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace pointsweep {
namespace {

using Whole = __int128;

constexpr double kNormalUnits = 1 << 20, kPlaceUnits = 4294967296.0, kFarthest = 1099511627776.0;

/// Sums over points with signs s, normals n and positions p. The members from `normal` to `first_sign` change their
/// sign if all s do.
struct Votes {
  std::array<Whole, 3> normal;  ///< Σ s n
  Whole out;                    ///< Σ s n · p
  std::int64_t facing;          ///< Σ sign(s n · (v - p))
  std::int64_t highest_sign;    ///< sign of s n_z of the highest point
  std::int64_t first_sign;      ///< s of the first point

  std::array<Whole, 3> place;  ///< Σ p
  std::int64_t points;
  Box box;
  PointKey highest, first;
};

Votes votes_at(const std::byte* bytes) {
  Votes votes;
  std::memcpy(&votes, bytes, sizeof votes);
  return votes;
}

std::int64_t sign_of(double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

bool is_higher(const PointKey& a, const PointKey& b) {
  return a.position.z != b.position.z ? a.position.z > b.position.z : a < b;
}

std::array<Whole, 3> whole_place(Vec3 p) {
  std::array<Whole, 3> place;
  for (int a = 0; a < 3; ++a)
    place[a] = static_cast<Whole>(std::nearbyint(std::clamp(p[a], -kFarthest, kFarthest) * kPlaceUnits));
  return place;
}

/// Returns `out` of OrientationVotes in the units of Votes::normal; 0 if the points have no extent.
long double outwards(const Votes& v) {
  const Vec3 extent = v.box.extent();
  const long double mean = (static_cast<long double>(extent.x) + extent.y + extent.z) / 3;
  if (mean == 0) return 0;
  long double out = static_cast<long double>(v.out);
  for (int a = 0; a < 3; ++a)
    out -= static_cast<long double>(v.place[a]) / static_cast<long double>(v.points) *
           static_cast<long double>(v.normal[a]);
  return out / (kPlaceUnits * mean);
}

}  // namespace

std::size_t OrientationVotes::bytes() const { return sizeof(Votes); }

void OrientationVotes::start(std::byte* bytes, const PointKey& point, const std::byte* ballot) const {
  std::array<float, 3> n;
  std::memcpy(n.data(), ballot, sizeof n);
  const Vec3 normal{n[0], n[1], n[2]};
  Votes v{};
  v.place = whole_place(point.position);
  for (int a = 0; a < 3; ++a) {
    if (is_finite(normal)) v.normal[a] = std::llrint(std::clamp(normal[a], -1.0, 1.0) * kNormalUnits);
    v.out += v.normal[a] * v.place[a];
  }
  if (viewpoint_) v.facing = sign_of(dot(normal, *viewpoint_ - point.position));
  v.highest_sign = sign_of(normal.z);
  v.first_sign = 1;
  v.points = 1;
  v.box = {point.position, point.position};
  v.highest = v.first = point;
  std::memcpy(bytes, &v, sizeof v);
}

void OrientationVotes::merge(std::byte* into, const std::byte* from, bool flips) const {
  Votes v = votes_at(into);
  const Votes w = votes_at(from);
  const int sign = flips ? -1 : 1;
  for (int a = 0; a < 3; ++a) {
    v.normal[a] += sign * w.normal[a];
    v.place[a] += w.place[a];
  }
  v.out += sign * w.out;
  v.facing += sign * w.facing;
  v.points += w.points;
  v.box.include(w.box);
  if (is_higher(w.highest, v.highest)) v.highest = w.highest, v.highest_sign = sign * w.highest_sign;
  if (w.first < v.first) v.first = w.first, v.first_sign = sign * w.first_sign;
  std::memcpy(into, &v, sizeof v);
}

void OrientationVotes::conclude(const std::byte* votes, std::byte* result) const {
  const Votes v = votes_at(votes);
  const long double up = static_cast<long double>(v.normal[2]), out = outwards(v);
  const long double vote = viewpoint_ ? v.facing : std::abs(up) >= std::abs(out) ? up : out;
  const bool turned = vote != 0 ? vote < 0 : v.highest_sign != 0 ? v.highest_sign < 0 : v.first_sign < 0;
  *result = std::byte(turned);
}

}  // namespace pointsweep
