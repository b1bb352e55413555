// SPDX-License-Identifier: MIT
#include "pointsweep/search/leaf_cut.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pointsweep/search/leaf_cut.cpp"
#include "pointsweep/math/instruction_sets.h"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include <algorithm>
#include <bit>

#include "pointsweep/search/cell.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// One cell while it is cut. Points stay where they are; what moves is their numbers.
class LeafCut {
 public:
  LeafCut(std::span<CutPoint> points, const std::function<std::uint64_t(std::uint32_t)>& row_of)
      : points_(points), row_of_(row_of) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t a = 0; a < 3; ++a) c_[a][i] = points[i].c[a];
      order_[i] = static_cast<std::uint32_t>(i);
    }
  }

  void run() {
    halve(0, points_.size());
    std::copy_n(points_.begin(), points_.size(), copy_);
    for (std::size_t i = 0; i < points_.size(); ++i) points_[i] = copy_[order_[i]];
  }

 private:
  using Floats = hn::CappedTag<float, kLeafCapacity>;
  using Keys = hn::RebindToUnsigned<Floats>;
  static constexpr std::size_t kRoom = kCellCapacity + kLeafCapacity;

  void halve(std::size_t first, std::size_t n) {
    if (n <= kLeafCapacity) return;
    const std::size_t left = (n / kLeafCapacity + 1) / 2 * kLeafCapacity;
    gather(first, n);
    const auto axis = longest();
    const float extent = hi_[axis] - lo_[axis];
    if (!(extent > kLeastExtent)) return by_row(first, n);
    make_keys(axis, n, extent);
    divide(first, n, left, select(n, left));
    halve(first, left);
    halve(first + left, n - left);
  }

  /// The coordinates of a range in its order, and their bounds.
  void gather(std::size_t first, std::size_t n) {
    const Floats d;
    const hn::RebindToSigned<Floats> di;
    for (std::size_t a = 0; a < 3; ++a) {
      auto lo = hn::Set(d, c_[a][order_[first]]), hi = lo;
      std::size_t i = 0;
      for (; i + hn::Lanes(d) <= n; i += hn::Lanes(d)) {
        const auto v = hn::GatherIndex(d, c_[a], hn::BitCast(di, hn::LoadU(Keys(), order_ + first + i)));
        hn::StoreU(v, d, ordered_[a] + i);
        lo = hn::Min(lo, v), hi = hn::Max(hi, v);
      }
      lo_[a] = hn::GetLane(hn::MinOfLanes(d, lo)), hi_[a] = hn::GetLane(hn::MaxOfLanes(d, hi));
      for (; i < n; ++i) {
        const float v = c_[a][order_[first + i]];
        ordered_[a][i] = v;
        lo_[a] = std::min(lo_[a], v), hi_[a] = std::max(hi_[a], v);
      }
    }
  }

  std::size_t longest() const {
    const float ex = hi_[0] - lo_[0], ey = hi_[1] - lo_[1], ez = hi_[2] - lo_[2];
    return ex >= ey && ex >= ez ? 0 : ey >= ez ? 1 : 2;
  }

  /// A coordinate as a whole number of as many bits as the place in the range leaves free, then that place.
  void make_keys(std::size_t axis, std::size_t n, float extent) {
    const Floats d;
    const hn::RebindToSigned<Floats> di;
    const int bits = std::countr_zero(std::bit_ceil(n));
    const auto lo = hn::Set(d, lo_[axis]);
    const auto scale = hn::Set(d, static_cast<float>((1 << 20) - 1) / extent);
    for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
      const auto v = hn::ConvertTo(di, hn::Mul(hn::Sub(hn::LoadU(d, ordered_[axis] + i), lo), scale));
      const auto key = hn::Or(hn::ShiftLeftSame(v, bits), hn::Iota(di, static_cast<std::int32_t>(i)));
      hn::StoreU(hn::BitCast(Keys(), key), Keys(), keys_ + i);
    }
    std::fill_n(keys_ + n, kLeafCapacity, kBeyondKeys);
  }

  /// A number that just `rank` of the keys, no two of which are equal, are below: by bisection, which needs no branch
  /// that anybody could mispredict.
  std::uint32_t select(std::size_t n, std::size_t rank) const {
    std::uint32_t low = 0, high = kBeyondKeys;
    for (;;) {
      const std::uint32_t middle = low + (high - low) / 2;
      const std::size_t below = count_below(n, middle);
      if (below == rank) return middle;
      below < rank ? low = middle : high = middle;
    }
  }

  std::size_t count_below(std::size_t n, std::uint32_t limit) const {
    const Keys d;
    const auto l = hn::Set(d, limit);
    std::size_t below = 0;
    for (std::size_t i = 0; i < n; i += hn::Lanes(d)) below += hn::CountTrue(d, hn::Lt(hn::LoadU(d, keys_ + i), l));
    return below;
  }

  /// Brings the `left` points with keys below `limit` to the front of the range, in the order they had.
  void divide(std::size_t first, std::size_t n, std::size_t left, std::uint32_t limit) {
    const Keys d;
    std::uint32_t *lows = sides_[0], *highs = sides_[1];
    std::size_t low = 0;
    for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
      const auto number = hn::LoadU(d, order_ + first + i);
      const auto real = hn::FirstN(d, std::min(n - i, hn::Lanes(d)));
      const auto goes_low = hn::Lt(hn::LoadU(d, keys_ + i), hn::Set(d, limit));
      const std::size_t taken = hn::CompressStore(number, hn::And(goes_low, real), d, lows + low);
      hn::CompressStore(number, hn::AndNot(goes_low, real), d, highs + (i - low));
      low += taken;
    }
    std::copy_n(lows, left, order_ + first);
    std::copy_n(highs, n - left, order_ + first + left);
  }

  void by_row(std::size_t first, std::size_t n) {
    const auto row = [this](std::uint32_t i) { return row_of_(points_[i].index); };
    std::sort(order_ + first, order_ + first + n, [&row](std::uint32_t a, std::uint32_t b) { return row(a) < row(b); });
  }

  static constexpr std::uint32_t kBeyondKeys = 0xFFFFFFFF;
  /// Below it the scale of the keys would overflow.
  static constexpr float kLeastExtent = 1e-30f;

  const std::span<CutPoint> points_;
  const std::function<std::uint64_t(std::uint32_t)>& row_of_;
  float lo_[3], hi_[3];
  HWY_ALIGN float c_[3][kRoom];
  HWY_ALIGN float ordered_[3][kRoom];
  HWY_ALIGN std::uint32_t order_[kRoom];
  HWY_ALIGN std::uint32_t sides_[2][kRoom];
  HWY_ALIGN std::uint32_t keys_[kRoom];
  CutPoint copy_[kCellCapacity];
};

void cut_cell(std::span<CutPoint> points, const std::function<std::uint64_t(std::uint32_t)>& row_of) {
  LeafCut(points, row_of).run();
}

}  // namespace HWY_NAMESPACE
}  // namespace pointsweep
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointsweep {
HWY_EXPORT(cut_cell);

void cut_into_leaves(std::span<CutPoint> points, const std::function<std::uint64_t(std::uint32_t)>& row_of) {
  HWY_DYNAMIC_DISPATCH(cut_cell)(points, row_of);
}

}  // namespace pointsweep
#endif
