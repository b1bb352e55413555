// SPDX-License-Identifier: MIT
/// Statistics of a list of finite values. The list must not be empty. Sums run in the order of the list. Values are
/// float64 or whole numbers of 64 bits; differences of whole numbers are exact before they become float64.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

#include "pointsweep/operators/expressions/expression.h"

namespace pointsweep {

template <class Value>
double difference(Value a, Value b) {
  if constexpr (std::is_integral_v<Value>)
    return static_cast<double>(WholeNumber{a} - WholeNumber{b});
  else
    return a - b;
}

/// Returns 1/n Σ (v_j - v_1), so that large values close to each other lose no digits.
template <class Value>
double mean_of_differences(std::span<const Value> values) {
  double sum = 0;
  for (const Value v : values) sum += difference(v, values[0]);
  return sum / static_cast<double>(values.size());
}

template <class Value>
double mean_of(std::span<const Value> values) {
  if constexpr (std::is_integral_v<Value>) {
    WholeNumber sum = 0;
    for (const Value v : values) sum += v;
    return static_cast<double>(sum) / static_cast<double>(values.size());
  } else {
    return values[0] + mean_of_differences(values);
  }
}

/// Returns the standard deviation of the whole population, √(1/n Σ (v_j - mean)²).
template <class Value>
double deviation_of(std::span<const Value> values) {
  const double mean = mean_of_differences(values);
  double squares = 0;
  for (const Value v : values) {
    const double d = difference(v, values[0]) - mean;
    squares += d * d;
  }
  return std::sqrt(squares / static_cast<double>(values.size()));
}

template <class Value>
double range_of_values(std::span<const Value> values) {
  const auto [least, greatest] = std::ranges::minmax_element(values);
  return difference(*greatest, *least);
}

/// Lists up to this length are sorted by the rank of each value: n² comparisons without a branch take less time than
/// the mispredicted branches of a sort.
inline constexpr std::size_t kSortedByRank = 32;

template <class Value>
void sort_by_rank(std::span<const Value> values, std::vector<Value>& sorted) {
  const std::size_t n = values.size();
  sorted.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::size_t rank = 0;
    for (std::size_t j = 0; j < i; ++j) rank += values[j] <= values[i];
    for (std::size_t j = i + 1; j < n; ++j) rank += values[j] < values[i];
    sorted[rank] = values[i];
  }
}

/// Returns the middle value, or half the sum of the two middle values, rounded once. `sorted` is overwritten.
template <class Value>
double median_of(std::span<const Value> values, std::vector<Value>& sorted) {
  const std::size_t half = values.size() / 2;
  Value below = values[0];
  if (values.size() <= kSortedByRank) {
    sort_by_rank(values, sorted);
    if (half > 0) below = sorted[half - 1];
  } else {
    sorted.assign(values.begin(), values.end());
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(half);
    std::nth_element(sorted.begin(), middle, sorted.end());
    below = *std::max_element(sorted.begin(), middle);
  }
  if (values.size() % 2 == 1) return static_cast<double>(sorted[half]);
  if constexpr (std::is_integral_v<Value>)
    return static_cast<double>(WholeNumber{below} + WholeNumber{sorted[half]}) / 2;
  else
    return below / 2 + sorted[half] / 2;
}

/// Returns the most frequent value; of equally frequent values, the first in the list. `sorted` may be overwritten.
template <class Value>
Value majority_of(std::span<const Value> values, std::vector<Value>& sorted) {
  if (values.size() <= kSortedByRank) {  // no sort: each value counts the equal values after it
    std::size_t first = 0, most = 0;
    for (std::size_t i = 0; i + most < values.size(); ++i) {
      std::size_t equal = 1;
      for (std::size_t j = i + 1; j < values.size(); ++j) equal += values[j] == values[i];
      if (equal > most) first = i, most = equal;
    }
    return values[first];
  }
  sorted.assign(values.begin(), values.end());
  std::ranges::sort(sorted);
  std::size_t most = 0, frequent = 0;  // length of the longest run; number of values with it, moved to the front
  for (std::size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
    while (end < sorted.size() && sorted[end] == sorted[begin]) ++end;
    if (end - begin > most) most = end - begin, frequent = 0;
    if (end - begin == most) sorted[frequent++] = sorted[begin];
  }
  const auto last = sorted.begin() + static_cast<std::ptrdiff_t>(frequent);
  return *std::ranges::find_if(values, [&](Value v) { return std::binary_search(sorted.begin(), last, v); });
}

}  // namespace pointsweep
