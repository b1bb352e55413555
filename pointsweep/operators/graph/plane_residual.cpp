// SPDX-License-Identifier: MIT
#include "pointsweep/operators/graph/plane_residual.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "pointsweep/math/exact_sum.h"
#include "pointsweep/math/symmetric3.h"

namespace pointsweep {
namespace {

constexpr double kUnits = 0x1p40, kFarthestPlace = 0x1p40;
constexpr std::array<std::array<std::size_t, 2>, 6> kEntries = {{{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};

/// Sums over the positions q of points, in units of 2^-40.
struct Moments {
  std::array<Int192, 6> second;  ///< Σ q_a q_b for the pairs (a, b) in kEntries
  std::array<Int128, 3> first;   ///< Σ q_a
  std::uint64_t points, placed;  ///< `placed`: number of points with finite places, which alone are in the sums
};

Moments moments_at(const std::byte* bytes) {
  Moments moments;
  std::memcpy(&moments, bytes, sizeof moments);
  return moments;
}

/// Returns Σ (q_a - c_a)(q_b - c_b) / n with the mean c. The sums are integers relative to a whole number m, which is c
/// without its fraction. The remainder r = Σ q - n m is below n in magnitude, so r_a r_b / n is subtracted in float64.
Symmetric3 covariance(const Moments& sums) {
  const auto n = static_cast<Int128>(sums.points);
  std::array<Int128, 3> mean, rest;
  for (std::size_t a = 0; a < 3; ++a) {
    mean[a] = sums.first[a] / n;
    rest[a] = sums.first[a] - n * mean[a];
  }
  std::array<double, 6> entry;
  const auto points = static_cast<double>(sums.points);
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [a, b] = kEntries[e];
    const Int192 around = sums.second[e] - Int192::product(mean[a], sums.first[b]) - Int192::product(mean[b], rest[a]);
    const double off = static_cast<double>(rest[a]) * static_cast<double>(rest[b]) / points;
    entry[e] = (static_cast<double>(around) - off) / points;
  }
  return {entry[0], entry[1], entry[2], entry[3], entry[4], entry[5]};
}

float residual(const Moments& sums) {
  if (sums.placed < sums.points) return std::numeric_limits<float>::quiet_NaN();
  if (sums.points < 4) return 0;
  const double least = eigen_symmetric3(covariance(sums)).value[0];
  return static_cast<float>(std::sqrt(std::max(0.0, least)) / kUnits);
}

}  // namespace

std::size_t PlaneResidual::bytes() const { return sizeof(Moments); }

void PlaneResidual::start(std::byte* votes, const PointKey& point, const std::byte* ballot) const {
  Vec3 place = point.position;
  if (moved_) std::memcpy(&place, ballot, sizeof place);
  Moments sums{.second = {}, .first = {}, .points = 1, .placed = is_finite(place) ? 1u : 0u};
  if (sums.placed == 1) {
    for (int a = 0; a < 3; ++a)
      sums.first[static_cast<std::size_t>(a)] =
          static_cast<Int128>(std::nearbyint(std::clamp(place[a], -kFarthestPlace, kFarthestPlace) * kUnits));
    for (std::size_t e = 0; e < 6; ++e)
      sums.second[e] = Int192::product(sums.first[kEntries[e][0]], sums.first[kEntries[e][1]]);
  }
  std::memcpy(votes, &sums, sizeof sums);
}

void PlaneResidual::merge(std::byte* into, const std::byte* from, bool) const {
  Moments sums = moments_at(into);
  const Moments more = moments_at(from);
  for (std::size_t e = 0; e < 6; ++e) sums.second[e] += more.second[e];
  for (std::size_t a = 0; a < 3; ++a) sums.first[a] += more.first[a];
  sums.points += more.points;
  sums.placed += more.placed;
  std::memcpy(into, &sums, sizeof sums);
}

void PlaneResidual::conclude(const std::byte* votes, std::byte* result) const {
  const float value = residual(moments_at(votes));
  std::memcpy(result, &value, sizeof value);
}

}  // namespace pointsweep
