// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/thinning.h"

#include <bit>
#include <cmath>
#include <limits>

namespace pointsweep::formulas {

std::uint64_t mixed(std::uint64_t n) {
  n += 0x9e3779b97f4a7c15u;
  n = (n ^ (n >> 30)) * 0xbf58476d1ce4e5b9u;
  n = (n ^ (n >> 27)) * 0x94d049bb133111ebu;
  return n ^ (n >> 31);
}

std::uint64_t hash_of(const Coordinates& p, std::uint64_t seed) {
  std::uint64_t hash = seed;
  for (const double c : p) hash = mixed(hash ^ std::bit_cast<std::uint64_t>(c + 0.0));  // -0 becomes 0
  return hash;
}

bool is_in_share(std::uint64_t hash, double share) { return std::ldexp(static_cast<double>(hash / 2048), -53) < share; }

std::uint64_t part_of(std::uint64_t hash, std::uint64_t parts) {
  const std::uint64_t high = hash / 0x100000000u, low = hash % 0x100000000u;
  return (high * parts + low * parts / 0x100000000u) / 0x100000000u;
}

Coordinates voxel_of(const Coordinates& p, double size) {
  Coordinates voxel{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double quotient = p[a] / size;
    voxel[a] = std::isfinite(quotient) ? std::floor(quotient) : std::copysign(1.7976931348623157e308, quotient);
  }
  return voxel;
}

double distance2_to_center(const Coordinates& p, double size) {
  const Coordinates voxel = voxel_of(p, size);
  double square[3];
  for (std::size_t a = 0; a < 3; ++a) {
    const double off = p[a] - (voxel[a] + 0.5) * size;
    square[a] = off * off;
  }
  return (square[0] + square[1]) + square[2];
}

void Mean::add(double value) {
  if (!std::isfinite(value)) return;
  sum_ += value, magnitudes_ += std::fabs(static_cast<Real>(value)), count_ += 1;
  are_whole_ = are_whole_ && value == std::trunc(value);
  least_ = std::fmin(least_, value), most_ = std::fmax(most_, value);
}

Estimate Mean::real() const {
  if (count_ == 0) return exactly(kNaN);
  if (least_ == most_) return exactly(least_);
  const Real mean = sum_ / count_;
  return scalar(mean, 0x1p-63L * magnitudes_ + 2 * kDouble * std::fabs(mean) + 0x1p-1074L);
}

Estimate Mean::single() const {
  Estimate e = real();
  if (e.error > 0) e.error += kSingle * (std::fabs(e.value.x) + e.error) + 0x1p-149L;
  return e;
}

Estimate Mean::whole() const {
  // Sums of whole numbers below 2^53 are exact, and so is a mean that lies halfway between two whole numbers.
  if (are_whole_ && count_ > 0 && magnitudes_ < 0x1p53L && std::fmod(2 * sum_, count_) == 0)
    return exactly(std::nearbyint(sum_ / count_));
  const Estimate e = real();
  const Real low = std::nearbyint(e.value.x - e.error), high = std::nearbyint(e.value.x + e.error);
  return low == high ? exactly(low) : open();
}

Estimate mean_vector(const std::array<Mean, 3>& components) {
  const Estimate x = components[0].real(), y = components[1].real(), z = components[2].real();
  return {.value = {x.value.x, y.value.x, z.value.x}, .error = x.error + y.error + z.error};
}

Estimate mean_direction(const std::array<Mean, 3>& components) {
  const Estimate e = mean_vector(components);
  const Real size = norm(e.value);
  if (!std::isfinite(size) || (size == 0 && e.error == 0)) return undefined();
  if (!(size > 2 * e.error)) return open();
  return single_direction(unit(e.value), 2 * e.error / size + 16 * kDouble);
}

}  // namespace pointsweep::formulas
