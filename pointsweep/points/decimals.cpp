// SPDX-License-Identifier: MIT
#include "pointsweep/points/decimals.h"

#include <cmath>
#include <limits>
#include <numeric>

namespace pointsweep {
namespace {

constexpr std::array<double, kMostDecimals + 1> kPowers{1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};

constexpr std::uint64_t kFewValues = 100;  ///< fewer values than this may share a divisor by chance

/// Returns the float64 nearest to `value` rounded to `decimals` digits after the point. Numerator and denominator are
/// whole numbers, exact below 2^53, and only the division rounds; so the result is the float64 nearest to the fraction.
double nearest(double value, int decimals) {
  const double power = kPowers[static_cast<std::size_t>(decimals)];
  return std::nearbyint(value * power) / power;
}

}  // namespace

std::optional<int> decimals_of(double value) {
  for (int decimals = 0; decimals <= kMostDecimals; ++decimals)
    if (nearest(value, decimals) == value) return decimals;
  return std::nullopt;
}

bool CommonStep::take(double value) {
  ++values_;
  if (nearest(value, decimals_) != value) {
    const std::optional<int> decimals = decimals_of(value);
    if (!decimals) return false;
    common_ *= static_cast<std::int64_t>(kPowers[static_cast<std::size_t>(*decimals - decimals_)]);
    decimals_ = *decimals;
  }
  if (common_ == 1) return true;
  const double steps = std::nearbyint(value * kPowers[static_cast<std::size_t>(decimals_)]);
  common_ = std::abs(steps) < 0x1p53 ? std::gcd(common_, static_cast<std::int64_t>(steps)) : 1;
  return true;
}

double CommonStep::size() const {
  const auto common = static_cast<double>(values_ < kFewValues ? 1 : common_);
  return common / kPowers[static_cast<std::size_t>(decimals_)];
}

GridDecimals::GridDecimals(const Field& field) : bias_(std::abs(field.bias)) {
  if (field.type == Type::f32 || field.type == Type::f64 || field.scale == 1) return;
  decimals_[0] = decimals_of(field.scale);
  const auto of_bias = decimals_of(field.bias);
  if (decimals_[0] && of_bias && *of_bias > *decimals_[0]) decimals_[1] = of_bias;
}

double GridDecimals::of(double value) const {
  const double tolerance = 4 * std::numeric_limits<double>::epsilon() * (std::abs(value) + bias_);
  for (const std::optional<int>& decimals : decimals_) {
    if (!decimals) continue;
    const double fraction = nearest(value, *decimals);
    if (std::abs(fraction - value) <= tolerance) return fraction;
  }
  return value;
}

}  // namespace pointsweep
