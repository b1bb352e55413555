// SPDX-License-Identifier: MIT
#include "pointsweep/info/value_moments.h"

#include <algorithm>
#include <cmath>

namespace pointsweep {
namespace {

/// Adds `value` without rounding, 32 bits at a time.
void add_whole(ExactSum& sum, Int128 value) {
  const double sign = value < 0 ? -1 : 1;
  auto rest = value < 0 ? -static_cast<UInt128>(value) : static_cast<UInt128>(value);
  for (double unit = sign; rest != 0; rest >>= 32, unit *= 0x1p32)
    sum.add(unit * static_cast<double>(static_cast<std::uint32_t>(rest)));
}

void add_square(ExactSum& sum, Int128 value) {
  const auto low = static_cast<double>(static_cast<std::uint32_t>(value));
  const double high = static_cast<double>(static_cast<std::int64_t>(value >> 32)) * 0x1p32;
  sum.add_product(high, high);
  sum.add_product(2 * high, low);
  sum.add_product(low, low);
}

std::optional<double> if_finite(double value) { return std::isfinite(value) ? std::optional(value) : std::nullopt; }

}  // namespace

ValueMoments::ValueMoments(const ValueKeys& keys, bool sums) {
  if (sums && !keys.is_small()) exact_ = std::make_unique<Sums>();
}

void ValueMoments::add(const ValueKeys& keys, std::uint64_t key) {
  if (!keys.is_finite(key)) {
    ++nonfinite_;
    return;
  }
  ++count_;
  least_ = std::min(least_, key);
  most_ = std::max(most_, key);
  if (keys.is_small()) {
    const auto value = static_cast<std::int64_t>(keys.whole(key));
    sum_ += value;
    squares_ += Int128{value} * value;
  } else if (exact_ && keys.is_whole()) {
    add_whole(exact_->values, keys.whole(key));
    add_square(exact_->squares, keys.whole(key));
  } else if (exact_) {
    const double value = keys.real(key);
    exact_->values.add(value);
    exact_->squares.add_product(value, value);
  }
}

ValueMoments::Sums ValueMoments::sums() const {
  if (exact_) return *exact_;
  Sums sums;
  add_whole(sums.values, sum_);
  add_whole(sums.squares, squares_);
  return sums;
}

std::optional<double> ValueMoments::mean() const {
  if (count_ == 0) return std::nullopt;
  return if_finite(sums().values.rounded() / static_cast<double>(count_));
}

std::optional<double> ValueMoments::deviation() const {
  if (count_ < 2) return std::nullopt;
  const auto n = static_cast<double>(count_);
  const Sums sums = this->sums();
  if (!if_finite(sums.squares.rounded())) return std::nullopt;
  return if_finite(std::sqrt(n_squared_variance(sums.values, sums.squares, n) / n / (n - 1)));
}

std::uint64_t ValueMoments::bytes(const ValueKeys& keys, bool sums) {
  return sizeof(ValueMoments) + (sums && !keys.is_small() ? sizeof(Sums) : 0);
}

}  // namespace pointsweep
