// SPDX-License-Identifier: MIT
/// Search among GatheredPoints (cell_search.h) for the points within a distance of a point, and sorting of these points
/// by bins of squared distances. Included once per instruction set.
#if defined(POINTSWEEP_SEARCH_BIN_SEARCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTSWEEP_SEARCH_BIN_SEARCH_INL_H_
#undef POINTSWEEP_SEARCH_BIN_SEARCH_INL_H_
#else
#define POINTSWEEP_SEARCH_BIN_SEARCH_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "pointsweep/math/front_lanes-inl.h"
#include "pointsweep/math/sort_lanes-inl.h"
#include "pointsweep/search/cell_search.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace pointsweep {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Sorts points by keys of 32 bits: a bin of squared distances above the number of the gathered point. A key with a
/// whole distance and a NeighborRef would have 64 bits, and sorting would take twice the time. Bins ascend with
/// distance; the caller orders points of equal bins.
class BinSearch {
 public:
  /// Prepares searches among the first `size` of the gathered points, within a squared distance of `limit2`.
  BinSearch(GatheredPoints& points, std::size_t size, double limit2)
      : points_(points), size_(size), limit2_(limit2), low_bits_(static_cast<std::uint32_t>(std::bit_width(size))) {}

  /// Returns whether squared distances up to `limit2` can be divided into bins without overflow or underflow.
  static bool can_bin(double limit2) { return limit2 > 1e-280 && limit2 < 1e280; }

  /// Finds the points within sqrt(limit2) of p, except the gathered point number `self`. Returns the number of found
  /// points. Sorts at least the first `wanted` of the found points.
  std::size_t find(Vec3 p, std::size_t self, std::size_t wanted) {
    const std::size_t count = keep(p, self);
    sorted_ = BinSort(low_bits_, points_.spare_key.data())
                  .Sort(points_.bin_key.data(), count, std::min(wanted, count), 0, bins());
    sharing_ = count_sharing();
    return count;
  }
  /// Returns the number of found points that are in order. They fill whole bins.
  std::size_t sorted() const { return sorted_; }
  /// Returns the number of ordered points that share the bin of the point before them.
  std::size_t sharing() const { return sharing_; }

  /// Writes the ordered points to `refs`, and calls order(span) for each bin with more than one point.
  template <class Order>
  void write(NeighborRef* refs, Order order) const {
    const std::uint32_t* const keys = points_.bin_key.data();
    const std::uint32_t number_bits = (std::uint32_t{1} << low_bits_) - 1;
    for (std::size_t j = 0; j < sorted_; ++j) refs[j] = points_.ref[keys[j] & number_bits];
    for (std::size_t begin = 0, end = 0; sharing_ > 0 && begin < sorted_; begin = end) {
      for (end = begin + 1; end < sorted_ && (keys[end - 1] ^ keys[end]) <= number_bits;) ++end;
      if (end - begin > 1) order(std::span(refs + begin, end - begin));
    }
  }

 private:
  std::size_t count_sharing() const {
    const ColumnSort<1>::Lanes d;
    const std::uint32_t* const keys = points_.bin_key.data();
    const auto number_bits = hn::Set(d, (std::uint32_t{1} << low_bits_) - 1);
    std::size_t count = 0;
    for (std::size_t i = 0; i + 1 < sorted_; i += hn::Lanes(d)) {
      const auto bin = hn::AndNot(number_bits, hn::LoadU(d, keys + i));
      const auto next = hn::AndNot(number_bits, hn::LoadU(d, keys + i + 1));
      count += hn::CountTrue(d, hn::And(hn::Eq(bin, next), hn::FirstN(d, sorted_ - 1 - i)));
    }
    return count;
  }
  std::uint64_t bins() const { return std::uint64_t{1} << std::min(32 - low_bits_, 24u); }

  std::size_t keep(Vec3 p, std::size_t self) {
    const hn::ScalableTag<double> d;
    const hn::Rebind<std::uint32_t, decltype(d)> du;
    const hn::Rebind<std::int32_t, decltype(d)> di;
    const std::size_t lanes = hn::Lanes(d);
    const GatheredPoints& from = points_;
    std::uint32_t* const keys = points_.bin_key.data();
    const auto px = hn::Set(d, p.x), py = hn::Set(d, p.y), pz = hn::Set(d, p.z), limit = hn::Set(d, limit2_);
    const auto per_distance2 = hn::Set(d, static_cast<double>(bins() - 1) / limit2_);
    const int shift = static_cast<int>(low_bits_);
    const auto beyond = hn::Set(d, -1.0);
    const auto own = hn::Set(di, static_cast<std::int32_t>(self)), none = hn::Set(di, -1);
    const auto end = hn::Set(di, static_cast<std::int32_t>(size_)),
               step = hn::Set(di, static_cast<std::int32_t>(lanes));
    auto number = hn::Iota(di, 0);  // a counter in lanes: conversion from `i` would go through memory
    std::size_t count = 0;
    for (std::size_t i = 0; i < size_; i += lanes, number = hn::Add(number, step)) {
      const auto dx = hn::Sub(hn::LoadU(d, &from.x[i]), px), dy = hn::Sub(hn::LoadU(d, &from.y[i]), py);
      const auto dz = hn::Sub(hn::LoadU(d, &from.z[i]), pz);
      const auto d2 = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
      const auto place = hn::IfThenElse(hn::Le(d2, limit), hn::Mul(d2, per_distance2), beyond);
      const auto bin = hn::DemoteTo(di, place);
      const auto within = hn::And(hn::Gt(bin, none), hn::Lt(number, end));
      const auto keep = hn::RebindMask(du, hn::AndNot(hn::Eq(number, own), within));
      const auto key = hn::BitCast(du, hn::Or(hn::ShiftLeftSame(bin, shift), number));
      hn::StoreU(Front<decltype(du)>(keep)(key), du, keys + count);
      count += hn::CountTrue(du, keep);
    }
    return count;
  }

  GatheredPoints& points_;
  const std::size_t size_;
  const double limit2_;
  const std::uint32_t low_bits_;
  std::size_t sorted_ = 0, sharing_ = 0;
};

}  // namespace HWY_NAMESPACE
}  // namespace pointsweep
HWY_AFTER_NAMESPACE();
#endif  // HWY_TARGET
#endif
