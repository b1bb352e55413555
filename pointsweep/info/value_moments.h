// SPDX-License-Identifier: MIT
/// Number, range, mean and standard deviation of values. The results do not depend on the order of the values.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

#include "pointsweep/info/value_keys.h"
#include "pointsweep/math/exact_sum.h"

namespace pointsweep {

/// Exact sums of values and of their squares: integers of 128 bits for whole numbers of up to 32 bits, else two sums of
/// 1.1 kB each.
class ValueMoments {
 public:
  /// `sums`: false for number and range only.
  ValueMoments(const ValueKeys& keys, bool sums);
  void add(const ValueKeys& keys, std::uint64_t key);

  std::uint64_t count() const { return count_; }          ///< number of finite values
  std::uint64_t nonfinite() const { return nonfinite_; }  ///< NaN and infinite values
  /// Returns the key of the least value; the greatest number if count() is 0.
  std::uint64_t least() const { return least_; }
  /// Returns the key of the greatest value; 0 if count() is 0.
  std::uint64_t most() const { return most_; }
  /// Returns the rounded sum divided by the number; none without values, or if the sum is beyond float64.
  std::optional<double> mean() const;
  /// Returns the square root of the sum of squared distances from the mean, divided by the number less 1; none for
  /// fewer than two values, or if the sum of their squares is beyond float64.
  std::optional<double> deviation() const;

  /// Returns the memory in bytes that an object takes.
  static std::uint64_t bytes(const ValueKeys& keys, bool sums);

 private:
  struct Sums {
    ExactSum values, squares;
  };
  /// Returns `exact_`, or else the sums of whole numbers in this form.
  Sums sums() const;

  std::uint64_t count_ = 0, nonfinite_ = 0;
  std::uint64_t least_ = std::numeric_limits<std::uint64_t>::max(), most_ = 0;
  Int128 sum_ = 0, squares_ = 0;  ///< sums for whole numbers of up to 32 bits
  std::unique_ptr<Sums> exact_;   ///< sums for all other values; null if not requested
};

}  // namespace pointsweep
