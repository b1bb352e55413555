// SPDX-License-Identifier: MIT
#include "pointsweep/math/sort.h"

#include <hwy/contrib/sort/vqsort.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <vector>

namespace pointsweep {
namespace {

constexpr std::uint64_t kSign = std::uint64_t{1} << 63;

/// Returns an integer for `v`; integers have the order of the doubles. Highway's own sort of doubles turns infinities
/// into the largest finite double.
std::uint64_t ordered(double v) {
  const auto bits = std::bit_cast<std::uint64_t>(v);
  return (bits & kSign) != 0 ? ~bits : bits | kSign;
}
double number_of(std::uint64_t ordered) {
  return std::bit_cast<double>((ordered & kSign) != 0 ? ordered ^ kSign : ~ordered);
}

template <class T>
void sort(T* numbers, std::size_t n) {
  if (n > 1) hwy::Sorter()(numbers, n, hwy::SortAscending());
}

}  // namespace

void sort_ascending(std::span<std::uint64_t> numbers) { sort(numbers.data(), numbers.size()); }

void sort_ascending(std::span<double> numbers) {
  std::vector<std::uint64_t> keys(numbers.size());
  std::ranges::transform(numbers, keys.begin(), ordered);
  sort(keys.data(), keys.size());
  std::ranges::transform(keys, numbers.begin(), number_of);
}

void sort_ascending(std::span<std::pair<double, double>> pairs) {
  std::vector<hwy::uint128_t> keys(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    keys[i].hi = ordered(pairs[i].first);
    keys[i].lo = ordered(pairs[i].second);
  }
  sort(keys.data(), keys.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = {number_of(keys[i].hi), number_of(keys[i].lo)};
}

}  // namespace pointsweep
