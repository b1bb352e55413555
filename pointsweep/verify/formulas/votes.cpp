// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/votes.h"

#include <cmath>

#include "pointsweep/verify/formulas/neighbor_statistics.h"

namespace pointsweep::formulas {

std::optional<Estimate> voted(std::string_view vote, const std::vector<Real>& values, bool are_whole) {
  if (values.empty()) return std::nullopt;
  if (vote == "nearest" || (vote == "majority" && values.size() == 1)) return Estimate{.value = {values.front(), 0, 0}};
  std::vector<Estimate> finite;
  Real sum = 0;
  for (const Real v : values) {
    if (!std::isfinite(v)) continue;
    finite.push_back({.value = {v, 0, 0}});
    sum += v;
  }
  if (finite.empty()) return std::nullopt;
  const bool is_exact = are_whole && std::fabs(sum) < 0x1p63L;  // a sum of whole numbers below 2^63 is exact
  if (vote == "mean" && is_exact)
    return Estimate{.value = {static_cast<double>(sum) / static_cast<double>(finite.size()), 0, 0}};
  return statistic_of(vote, finite);
}

Estimate stored(const Estimate& value, Storage storage) {
  if (value.is_open()) return open();
  if (value.error > 0) return stored_number({value.value.x - value.error, value.value.x + value.error, false}, storage);
  return stored_number(
      {value.value.x, value.value.x, storage == Storage::whole && std::nearbyint(value.value.x) == value.value.x},
      storage);
}

}  // namespace pointsweep::formulas
