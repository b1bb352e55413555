// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/thinning.h"

#include <cmath>
#include <cstring>

namespace pointsweep::formulas {

std::uint64_t hash_of(const Coordinates& p, std::uint64_t seed) {
  std::uint64_t h = seed;
  for (double c : p) {
    if (c == 0) c = 0;
    std::uint64_t bits = 0;
    std::memcpy(&bits, &c, sizeof bits);
    h = (h ^ bits) + 0x9e3779b97f4a7c15u;
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    h = h ^ (h >> 31);
  }
  return h;
}

bool is_in_share(std::uint64_t hash, double share) { return std::ldexp(static_cast<double>(hash / 2048), -53) < share; }

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

}  // namespace pointsweep::formulas
