// SPDX-License-Identifier: MIT
#include "pointsweep/order/canonical_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <limits>
#include <memory>
#include <numeric>

namespace pointsweep {
namespace {

constexpr int kDigitBits = 9;               ///< one cache line for each of 512 buckets fits in 32 KB of cache
constexpr std::size_t kSmall = 128;         ///< up to this many points, a sort by comparisons is faster
constexpr std::size_t kPrefetchAhead = 24;  ///< number of points ahead whose coordinates are prefetched

/// Maps finite doubles to integers in the same order; -0 and 0 map to the same integer.
std::uint64_t ascending_bits(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value + 0.0);
  return bits >> 63 ? ~bits : bits | std::uint64_t{1} << 63;
}

int bits_of(std::uint64_t value) { return 64 - std::countl_zero(value); }

/// Sorts level by level: the axis coordinate, the other two, the row. A radix sort takes 32 significant bits of a
/// level at a time; ties are sorted by the remaining bits or by the next level.
class CanonicalSort {
 public:
  CanonicalSort(int axis, std::span<const double> x, std::span<const double> y, std::span<const double> z,
                std::span<const std::uint64_t> row, std::span<std::uint32_t> order)
      : row_(row.data()),
        order_(order.data()),
        items_(std::make_unique_for_overwrite<std::uint64_t[]>(2 * order.size())),
        spare_(items_.get() + order.size()) {
    const std::array<const double*, 3> xyz = {x.data(), y.data(), z.data()};
    levels_[0] = xyz[static_cast<std::size_t>(axis)];
    for (std::size_t a = 0, level = 1; a < 3; ++a)
      if (static_cast<int>(a) != axis) levels_[level++] = xyz[a];
  }

  /// Sorts order_[begin, end), whose points are equal in the levels before `level`.
  void sort(std::size_t level, std::size_t begin, std::size_t end) {
    if (end - begin <= kSmall) return sort_small(level, begin, end);
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max(), greatest = 0, ones = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint64_t k = key(level, order_[i]);
      least = std::min(least, k);
      greatest = std::max(greatest, k);
      ones |= k;
    }
    if (least == greatest) {
      if (level < kLevels) sort(level + 1, begin, end);
      return;
    }
    // Low bits that are 0 in all keys are skipped: 29 bits if the coordinates are floats and not negative.
    const int zeros = std::countr_zero(ones);
    const int width = bits_of((greatest >> zeros) - (least >> zeros));
    const int shift = zeros + std::max(0, width - 32);
    for (std::size_t i = begin; i < end; ++i)
      items_[i] = ((key(level, order_[i]) >> shift) - (least >> shift)) << 32 | order_[i];
    radix_sort(begin, end, bits_of((greatest >> shift) - (least >> shift)));
    for (std::size_t i = begin; i < end; ++i) order_[i] = static_cast<std::uint32_t>(items_[i]);
    // Points with equal keys in the items are equal at this level if these keys contain all its bits.
    settle_ties(shift == zeros ? level + 1 : level, begin, end);
  }

 private:
  static constexpr std::size_t kLevels = 3;  ///< three coordinates; the level after them is the row

  std::uint64_t key(std::size_t level, std::uint32_t i) const {
    return level < kLevels ? ascending_bits(levels_[level][i]) : row_[i];
  }

  struct Keyed {
    std::uint64_t key;
    std::uint32_t index;
  };

  /// Sorts up to kSmall points by comparisons, over copies of their keys in one array.
  void sort_small(std::size_t level, std::size_t begin, std::size_t end) {
    std::array<Keyed, kSmall> keyed;  // only the first n entries are filled and used
    const std::size_t n = end - begin;
    for (std::size_t i = 0; i < n; ++i) keyed[i] = {key(level, order_[begin + i]), order_[begin + i]};
    std::sort(keyed.begin(), keyed.begin() + static_cast<std::ptrdiff_t>(n),
              [](const Keyed& a, const Keyed& b) { return a.key < b.key; });
    for (std::size_t i = 0; i < n; ++i) order_[begin + i] = keyed[i].index;
    for (std::size_t i = 0, j = 1; level < kLevels && i < n; i = j++) {
      while (j < n && keyed[j].key == keyed[i].key) ++j;
      if (j - i > 1) sort(level + 1, begin + i, begin + j);
    }
  }

  /// Stable radix sort by bits [32, 32 + key_bits) of the items.
  void radix_sort(std::size_t begin, std::size_t end, int key_bits) {
    const std::size_t n = end - begin;
    std::uint64_t* from = items_.get() + begin;
    std::uint64_t* to = spare_ + begin;
    for (int bit = 32; bit < 32 + key_bits; bit += kDigitBits) {
      std::array<std::uint32_t, (1u << kDigitBits) + 1> place{};
      const auto digit = [bit](std::uint64_t item) { return item >> bit & ((1u << kDigitBits) - 1); };
      for (std::size_t i = 0; i < n; ++i) ++place[digit(from[i]) + 1];
      std::partial_sum(place.begin(), place.end(), place.begin());
      for (std::size_t i = 0; i < n; ++i) to[place[digit(from[i])]++] = from[i];
      std::swap(from, to);
    }
    if (from != items_.get() + begin) std::copy(from, from + n, items_.get() + begin);
  }

  /// Sorts each range of items with equal keys, by `level` and then by the levels after it.
  void settle_ties(std::size_t level, std::size_t begin, std::size_t end) {
    if (level > kLevels) return;
    const double* ahead = levels_[std::min(level, kLevels - 1)];
    for (std::size_t i = begin, j = begin; i < end; i = j) {
      const std::uint64_t tied = items_[i] >> 32;
      for (; j < end && items_[j] >> 32 == tied; ++j)
        __builtin_prefetch(ahead + static_cast<std::uint32_t>(items_[std::min(j + kPrefetchAhead, end - 1)]));
      if (j - i > 1) sort(level, i, j);
    }
  }

  std::array<const double*, kLevels> levels_{};
  const std::uint64_t* row_;
  std::uint32_t* order_;
  std::unique_ptr<std::uint64_t[]> items_;  ///< key << 32 | index
  std::uint64_t* spare_;
};

}  // namespace

void canonical_order(int axis, std::span<const double> x, std::span<const double> y, std::span<const double> z,
                     std::span<const std::uint64_t> row, std::vector<std::uint32_t>& order) {
  assert(x.size() == y.size() && y.size() == z.size() && z.size() == row.size());
  order.resize(x.size());
  std::iota(order.begin(), order.end(), 0u);
  CanonicalSort(axis, x, y, z, row, order).sort(0, 0, order.size());
}

}  // namespace pointsweep
