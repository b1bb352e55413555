// SPDX-License-Identifier: MIT
/// Sorting of the 32-bit keys of one neighbourhood, tens to thousands of them, in vector lanes. Included once per
/// instruction set.
///
/// Highway's own sort is made for arrays that are larger than a cache: each call gets random numbers from the system,
/// which takes as long as sorting a hundred keys.
#if defined(POINTSWEEP_MATH_SORT_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTSWEEP_MATH_SORT_LANES_INL_H_
#undef POINTSWEEP_MATH_SORT_LANES_INL_H_
#else
#define POINTSWEEP_MATH_SORT_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "pointsweep/math/front_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Bitonic sort of a matrix of R rows, each of which is a vector. Sorted keys ascend column by column: down the first
/// column, then down the second. So keys of one column are compared without moving them between lanes.
template <std::size_t R>
class ColumnSort {
 public:
  using Lanes = hn::CappedTag<std::uint32_t, 16>;
  using V = hn::Vec<Lanes>;
  static constexpr std::size_t kLanes = hn::MaxLanes(Lanes()), kMost = R * kLanes;

  /// Sorts `size` <= kMost keys; reads and writes whole vectors. No key may be the greatest number.
  static HWY_INLINE void Sort(std::uint32_t* keys, std::size_t size) {
    const Lanes d;
    const V none = hn::Set(d, std::numeric_limits<std::uint32_t>::max());
    V rows[R];
    HWY_UNROLL(8)
    for (std::size_t r = 0; r < R; ++r) {
      const std::size_t begin = std::min(r * kLanes, size);
      rows[r] = hn::IfThenElse(hn::FirstN(d, size - begin), hn::LoadU(d, keys + begin), none);
    }
    SortColumns(rows);
    if constexpr (kLanes > 1) MergeColumns<1>(rows);
    if constexpr (kLanes > 2) MergeColumns<2>(rows);
    if constexpr (kLanes > 4) MergeColumns<4>(rows);
    if constexpr (kLanes > 8) MergeColumns<8>(rows);
    HWY_ALIGN std::uint32_t matrix[kMost];
    HWY_UNROLL(8)
    for (std::size_t r = 0; r < R; ++r) hn::Store(rows[r], d, matrix + r * kLanes);
    for (std::size_t column = 0; column * R < size; ++column)
      for (std::size_t r = 0; r < R; ++r) keys[column * R + r] = matrix[r * kLanes + column];
  }

 private:
  static HWY_INLINE void Order(V& low, V& high) {
    const V a = low;
    low = hn::Min(a, high), high = hn::Max(a, high);
  }
  static HWY_INLINE void SortColumns(V (&rows)[R]) {
    HWY_UNROLL(4)
    for (std::size_t size = 2; size <= R; size *= 2) {
      HWY_UNROLL(8)
      for (std::size_t r = 0; r < R; ++r)
        if (const std::size_t other = r ^ (size - 1); r < other) Order(rows[r], rows[other]);
      MergeRows(rows, size / 4);
    }
  }
  /// Sorts bitonic columns of 2 `distance` rows.
  static HWY_INLINE void MergeRows(V (&rows)[R], std::size_t distance) {
    HWY_UNROLL(4)
    for (; distance > 0; distance /= 2) {
      HWY_UNROLL(8)
      for (std::size_t r = 0; r < R; ++r)
        if (const std::size_t other = r ^ distance; r < other) Order(rows[r], rows[other]);
    }
  }
  /// Returns, in each lane l, the value of lane l ^ kChange.
  template <std::uint32_t kChange>
  static HWY_INLINE V Exchanged(V v) {
    const Lanes d;
    return hn::TableLookupLanes(v, hn::IndicesFromVec(d, hn::Xor(hn::Iota(d, 0), hn::Set(d, kChange))));
  }
  template <std::uint32_t kBit>
  static HWY_INLINE hn::Mask<Lanes> LanesWith() {
    const Lanes d;
    return hn::Ne(hn::And(hn::Iota(d, 0), hn::Set(d, kBit)), hn::Zero(d));
  }
  /// Merges each pair of sorted groups of kGroup columns into one group.
  template <std::uint32_t kGroup>
  static HWY_INLINE void MergeColumns(V (&rows)[R]) {
    const auto upper = LanesWith<kGroup>();
    HWY_UNROLL(8)
    for (std::size_t r = 0; r < (R + 1) / 2; ++r) {
      const V a = rows[r], b = Exchanged<2 * kGroup - 1>(rows[R - 1 - r]);
      const V low = hn::Min(a, b), high = hn::Max(a, b);
      rows[r] = hn::IfThenElse(upper, high, low);
      if (r != R - 1 - r) rows[R - 1 - r] = Exchanged<2 * kGroup - 1>(hn::IfThenElse(upper, low, high));
    }
    if constexpr (kGroup >= 8) MergeLanes<4>(rows);
    if constexpr (kGroup >= 4) MergeLanes<2>(rows);
    if constexpr (kGroup >= 2) MergeLanes<1>(rows);
    MergeRows(rows, R / 2);
  }
  template <std::uint32_t kDistance>
  static HWY_INLINE void MergeLanes(V (&rows)[R]) {
    const auto upper = LanesWith<kDistance>();
    HWY_UNROLL(8)
    for (std::size_t r = 0; r < R; ++r) {
      const V other = Exchanged<kDistance>(rows[r]);
      rows[r] = hn::IfThenElse(upper, hn::Max(rows[r], other), hn::Min(rows[r], other));
    }
  }
};

/// Sorts keys of the form (bin | `low_bits` bits that distinguish keys of one bin). The sort is fast if keys are spread
/// evenly over the bins. No key may be the greatest number.
class BinSort {
  using Few = ColumnSort<8>;
  using Lanes = Few::Lanes;
  using V = Few::V;

 public:
  /// Number of places for keys beyond the end of `keys` that Sort() may read and write.
  static constexpr std::size_t kPadding = Few::kMost;

  /// `spare` has room for twice as many keys as are sorted at once, and for kPadding more.
  BinSort(std::uint32_t low_bits, std::uint32_t* spare) : low_bits_(low_bits), spare_(spare) {}

  /// Sorts `keys`, of the bins [first, end), until at least the first `wanted` keys are in order. Returns the number of
  /// keys in order; these keys fill whole bins, and all other keys are greater.
  std::size_t Sort(std::uint32_t* keys, std::size_t size, std::size_t wanted, std::uint64_t first, std::uint64_t end) {
    return SortPart(keys, size, wanted, first, end, 0);
  }

 private:
  std::size_t SortPart(std::uint32_t* keys, std::size_t size, std::size_t wanted, std::uint64_t first,
                       std::uint64_t end, int depth) {
    if (size <= Few::kMost) {
      SortFew(keys, size);
      return size;
    }
    if (depth == 2 || end - first == 1) {
      std::sort(keys, keys + size);
      return size;
    }
    constexpr std::size_t kPart = Few::kMost * 3 / 4, kMostParts = 16;
    const std::size_t parts = std::min(size / kPart + 1, kMostParts);
    std::uint32_t* const all = spare_;
    spare_ += size;
    std::copy_n(keys, size, all);
    std::size_t sorted = 0;
    // Each part is extracted from all keys in turn: the keys are few enough for the first-level cache.
    for (std::size_t p = 0; p < parts && sorted < wanted; ++p) {
      const std::uint64_t from = first + (end - first) * p / parts, to = first + (end - first) * (p + 1) / parts;
      if (from == to) continue;
      const std::size_t taken = Take(all, size, from, to, keys + sorted);
      sorted += SortPart(keys + sorted, taken, wanted - sorted, from, to, depth + 1);
    }
    spare_ = all;
    return sorted;
  }

  /// Copies the keys of the bins [first, end) to `to`, and returns their number.
  std::size_t Take(const std::uint32_t* keys, std::size_t size, std::uint64_t first, std::uint64_t end,
                   std::uint32_t* to) const {
    const Lanes d;
    const auto low = static_cast<std::uint32_t>(first << low_bits_);
    const V least = hn::Set(d, low), most = hn::Set(d, static_cast<std::uint32_t>((end << low_bits_) - 1) - low);
    std::size_t count = 0;
    for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
      const V key = hn::LoadU(d, keys + i), above = hn::Sub(key, least);
      const auto taken = hn::And(hn::Eq(hn::Min(above, most), above), hn::FirstN(d, size - i));
      hn::StoreU(Front<Lanes>(taken)(key), d, to + count);
      count += hn::CountTrue(d, taken);
    }
    return count;
  }

  static void SortFew(std::uint32_t* keys, std::size_t size) {
    if (size <= ColumnSort<1>::kMost) return ColumnSort<1>::Sort(keys, size);
    if (size <= ColumnSort<2>::kMost) return ColumnSort<2>::Sort(keys, size);
    if (size <= ColumnSort<4>::kMost) return ColumnSort<4>::Sort(keys, size);
    Few::Sort(keys, size);
  }

  const std::uint32_t low_bits_;
  std::uint32_t* spare_;
};

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
