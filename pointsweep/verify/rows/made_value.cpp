// SPDX-License-Identifier: MIT
#include "pointsweep/verify/rows/made_value.h"

#include <fmt/format.h>

namespace pointsweep {

using formulas::Estimate;
using formulas::Real;
using formulas::Vector;

namespace {

Real component_of(Vector v, std::size_t c) { return c == 0 ? v.x : c == 1 ? v.y : v.z; }

bool is_exact(const Estimate& e) { return e.error == 0 && !e.either_sign && !e.may_be_undefined; }

bool are_equal(const FieldPair& pair, const std::byte* result, const std::byte* record) {
  return pair.expected(result) == pair.found(record) ||
         (std::isnan(pair.expected_value(result)) && std::isnan(pair.found_value(record)));
}

}  // namespace

Real MadeValue::distance_to(Vector expected, const std::byte* record) const {
  Real sum2 = 0;
  for (std::size_t c = 0; c < pairs_.size(); ++c) {
    if (!pairs_[c]) continue;
    const Real wanted = component_of(expected, c), found = pairs_[c]->found_value(record);
    const Real beyond = std::fabs(found - wanted) - pairs_[c]->resolution(static_cast<double>(wanted));
    if (std::isnan(beyond)) return formulas::kInfinity;
    sum2 += beyond > 0 ? beyond * beyond : 0;
  }
  return std::sqrt(sum2);
}

Real MadeValue::distance(const Estimate& e, const std::byte* record) const {
  Real least = distance_to(e.value, record);
  if (e.either_sign) least = std::min(least, distance_to(Real{-1} * e.value, record));
  if (e.may_be_undefined && distance_to({}, record) == 0) least = 0;
  return least;
}

std::optional<std::size_t> MadeValue::wrong_component(const Estimate& e, const std::byte* result,
                                                      const std::byte* record) const {
  if (e.is_open()) return std::nullopt;
  if (is_exact(e)) {
    for (std::size_t c = 0; c < pairs_.size(); ++c)
      if (pairs_[c] && !are_equal(*pairs_[c], result, record)) return c;
    return std::nullopt;
  }
  if (distance(e, record) <= e.error) return std::nullopt;
  std::size_t worst = 0;
  Real most = -1;
  for (std::size_t c = 0; c < pairs_.size(); ++c) {
    if (!pairs_[c]) continue;
    const Real off = std::fabs(pairs_[c]->found_value(record) - component_of(e.value, c));
    if (!(off <= most)) most = off, worst = c;
  }
  return worst;
}

std::string MadeValue::difference(std::size_t c, const Estimate& e, const std::byte* result,
                                  const std::byte* record) const {
  std::string text = fmt::format("{} is {}, but {} by brute force", pairs_[c]->name(), pairs_[c]->found_value(record),
                                 pairs_[c]->expected_value(result));
  if (!is_exact(e)) text += fmt::format(", give or take {:.1e}", static_cast<double>(e.error));
  return text;
}

}  // namespace pointsweep
