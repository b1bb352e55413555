// SPDX-License-Identifier: MIT
#include "pointsweep/search/cut.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pointsweep/search/cut.cpp"
#include "pointsweep/math/instruction_sets.h"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cassert>

#include "pointsweep/math/front_lanes-inl.h"
#include "pointsweep/neighborhood.h"
#include "pointsweep/search/cell.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Cuts one cell into leaves. Each halving partitions arrays with the coordinates and numbers of the points.
class LeafCut {
 public:
  LeafCut(std::span<CutPoint> points, const std::function<std::uint64_t(std::uint32_t)>& row_of)
      : points_(points), row_of_(row_of) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t a = 0; a < 3; ++a) c_[a][i] = points[i].c[a];
      order_[i] = static_cast<std::int32_t>(i);
    }
  }

  void run() {
    halve(0, points_.size());
    std::copy_n(points_.begin(), points_.size(), copy_);
    for (std::size_t i = 0; i < points_.size(); ++i) points_[i] = copy_[order_[i]];
  }

 private:
  using Floats = hn::CappedTag<float, kLeafCapacity>;
  using Keys = hn::RebindToSigned<Floats>;
  static constexpr std::size_t kRoom = kCellCapacity + kLeafCapacity;

  void halve(std::size_t first, std::size_t n) {
    if (n <= kLeafCapacity) return;
    const std::size_t left = (n / kLeafCapacity + 1) / 2 * kLeafCapacity;
    const Side side = longest(first, n);
    if (!(side.extent > kLeastExtent)) return by_row(first, n);
    divide(first, n, left, select(n, left, make_keys(side, first, n)));
    halve(first, left);
    halve(first + left, n - left);
  }

  /// A side of the box of a range.
  struct Side {
    std::size_t axis;
    float lo, extent;
  };

  Side longest(std::size_t first, std::size_t n) const {
    const Floats d;
    Side sides[3];
    for (std::size_t a = 0; a < 3; ++a) {
      const float* c = c_[a] + first;
      auto lo = hn::LoadU(d, c + n - hn::Lanes(d)), hi = lo;  // a range holds more than a vector
      for (std::size_t i = 0; i + hn::Lanes(d) <= n; i += hn::Lanes(d)) {
        const auto v = hn::LoadU(d, c + i);
        lo = hn::Min(lo, v), hi = hn::Max(hi, v);
      }
      const float least = hn::GetLane(hn::MinOfLanes(d, lo));
      sides[a] = {a, least, hn::GetLane(hn::MaxOfLanes(d, hi)) - least};
    }
    const float x = sides[0].extent, y = sides[1].extent, z = sides[2].extent;
    return sides[x >= y && x >= z ? 0 : y >= z ? 1 : 2];
  }

  /// Fills keys_ with distinct keys in the order of the coordinates: the leading bits hold a coordinate as a whole
  /// number, the others the place in the range. Returns a number that no key exceeds.
  std::int32_t make_keys(const Side& side, std::size_t first, std::size_t n) {
    const Floats d;
    const Keys di;
    const int bits = std::countr_zero(std::bit_ceil(n));
    const auto lo = hn::Set(d, side.lo);
    const auto scale = hn::Set(d, static_cast<float>((1 << kCoordinateBits) - 1) / side.extent);
    const auto next = hn::Set(di, static_cast<std::int32_t>(hn::Lanes(di)));
    auto place = hn::Iota(di, 0);
    for (std::size_t i = 0; i < n; i += hn::Lanes(d), place = hn::Add(place, next)) {
      const auto v = hn::ConvertTo(di, hn::Mul(hn::Sub(hn::LoadU(d, c_[side.axis] + first + i), lo), scale));
      hn::StoreU(hn::Or(hn::ShiftLeftSame(v, bits), place), di, keys_ + i);
    }
    std::fill_n(keys_ + n, kLeafCapacity, kBeyondKeys);
    return static_cast<std::int32_t>(std::min(std::int64_t{1} << (kCoordinateBits + bits), std::int64_t{kBeyondKeys}));
  }

  /// Returns a number with exactly `rank` keys below it, by bisection. Vector lanes count the keys without branches.
  std::int32_t select(std::size_t n, std::size_t rank, std::int32_t high) const {
    std::int32_t low = 0;
    for (;;) {
      const std::int32_t middle = low + (high - low) / 2;
      const std::size_t below = count_below(n, middle);
      if (below == rank) return middle;
      below < rank ? low = middle : high = middle;
    }
  }

  std::size_t count_below(std::size_t n, std::int32_t limit) const {
    const Keys d;
    const auto l = hn::Set(d, limit);
    auto below = hn::Zero(d);
    for (std::size_t i = 0; i < n; i += hn::Lanes(d))
      below = hn::Sub(below, hn::VecFromMask(d, hn::Lt(hn::LoadU(d, keys_ + i), l)));  // a true lane is -1
    return static_cast<std::size_t>(hn::GetLane(hn::SumOfLanes(d, below)));
  }

  /// Brings the `left` points with keys below `limit` to the front of the range. Both sides keep their order.
  void divide(std::size_t first, std::size_t n, std::size_t left, std::int32_t limit) {
    const Floats d;
    const Keys di;
    std::size_t low = 0;
    for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
      const auto goes_low = hn::Lt(hn::LoadU(di, keys_ + i), hn::Set(di, limit));
      const Front<Keys> low_ones(goes_low), high_ones(hn::Not(goes_low));
      // Stores whole vectors; the next store overwrites the lanes after the chosen values. This is faster than masked
      // stores.
      const auto number = hn::LoadU(di, order_ + first + i);
      hn::StoreU(low_ones(number), di, low_order_ + low);
      hn::StoreU(high_ones(number), di, high_order_ + (i - low));
      for (std::size_t a = 0; a < 3; ++a) {
        const auto v = hn::LoadU(d, c_[a] + first + i);
        hn::StoreU(low_ones(v), d, low_[a] + low);
        hn::StoreU(high_ones(v), d, high_[a] + (i - low));
      }
      low += hn::CountTrue(di, goes_low);
    }
    const auto put_back = [&](const auto* lows, const auto* highs, auto* all) {
      std::copy_n(lows, left, all + first);
      std::copy_n(highs, n - left, all + first + left);
    };
    put_back(low_order_, high_order_, order_);
    for (std::size_t a = 0; a < 3; ++a) put_back(low_[a], high_[a], c_[a]);
  }

  void by_row(std::size_t first, std::size_t n) {
    const auto row = [this](std::int32_t i) { return row_of_(points_[static_cast<std::size_t>(i)].index); };
    std::sort(order_ + first, order_ + first + n, [&row](std::int32_t a, std::int32_t b) { return row(a) < row(b); });
  }

  static constexpr int kCoordinateBits = 20;  ///< bits of a coordinate in a key of 31 bits; 11 bits hold the place
  static constexpr std::int32_t kBeyondKeys = 0x7FFFFFFF;
  /// Least extent of a range that is divided: with a smaller extent, the scale of the keys could overflow.
  static constexpr float kLeastExtent = 1e-30f;

  const std::span<CutPoint> points_;
  const std::function<std::uint64_t(std::uint32_t)>& row_of_;
  HWY_ALIGN float c_[3][kRoom];
  HWY_ALIGN std::int32_t order_[kRoom];
  HWY_ALIGN std::int32_t keys_[kRoom];
  HWY_ALIGN float low_[3][kRoom], high_[3][kRoom];
  HWY_ALIGN std::int32_t low_order_[kRoom], high_order_[kRoom];
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
namespace {

struct Extent {
  std::array<float, 3> lo, hi;
  int longest() const {
    const float ex = hi[0] - lo[0], ey = hi[1] - lo[1], ez = hi[2] - lo[2];
    return ex >= ey && ex >= ez ? 0 : ey >= ez ? 1 : 2;
  }
};

Extent extent_of(std::span<const CutPoint> points) {
  Extent e{points[0].c, points[0].c};
  for (const CutPoint& point : points) {
    for (std::size_t a = 0; a < 3; ++a) {
      e.lo[a] = std::min(e.lo[a], point.c[a]);
      e.hi[a] = std::max(e.hi[a], point.c[a]);
    }
  }
  return e;
}

/// Moves the points for which goes_left() holds to the front, without a branch (Lomuto's scheme). Returns the number of
/// these points.
template <class Predicate>
std::size_t partition_branchless(CutPoint* points, std::size_t n, Predicate goes_left) {
  std::size_t left = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const CutPoint point = points[i];
    points[i] = points[left];
    points[left] = point;
    left += goes_left(point);
  }
  return left;
}

/// Returns a value near the `rank`-th smallest coordinate, from a strided sample.
float pivot_near(const CutPoint* points, std::size_t n, std::size_t rank, std::size_t axis) {
  constexpr std::size_t kMost = 31;
  const std::size_t m = n < 64 ? 5 : n < 512 ? 15 : kMost;
  std::array<float, kMost> sample{};
  for (std::size_t i = 0; i < m; ++i) sample[i] = points[i * n / m].c[axis];
  const std::size_t at = std::min(m - 1, rank * m / n);
  std::nth_element(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(at),
                   sample.begin() + static_cast<std::ptrdiff_t>(m));
  return sample[at];
}

/// Quickselect by the coordinate on `axis`: rearranges the points so that no point of the first `rank` exceeds a point
/// after them.
void select(CutPoint* points, std::size_t n, std::size_t rank, std::size_t axis) {
  while (rank > 0 && rank < n) {
    if (n <= 8) {
      std::sort(points, points + n, [axis](const CutPoint& a, const CutPoint& b) { return a.c[axis] < b.c[axis]; });
      return;
    }
    const float pivot = pivot_near(points, n, rank, axis);
    const std::size_t below = partition_branchless(points, n, [=](const CutPoint& i) { return i.c[axis] < pivot; });
    if (rank <= below && below < n) {
      n = below;
      continue;
    }
    const std::size_t equal =
        partition_branchless(points + below, n - below, [=](const CutPoint& i) { return !(pivot < i.c[axis]); });
    if (rank <= below + equal) return;
    points += below + equal, n -= below + equal, rank -= below + equal;
  }
}

using RowOf = std::function<std::uint64_t(std::uint32_t)>;

/// Cuts points into cells and appends the end of each cell to `begin`.
class Cutter {
 public:
  Cutter(const RowOf& row_of, std::uint32_t cell_points, std::vector<std::uint32_t>& begin)
      : row_of_(row_of), cell_points_(cell_points), begin_(begin) {}

  void into_cells(CutPoint* points, std::size_t n) {
    if (n <= cell_points_) {
      begin_.push_back(begin_.back() + static_cast<std::uint32_t>(n));
      return;
    }
    const Extent e = extent_of({points, n});
    const auto axis = static_cast<std::size_t>(e.longest());
    if (!(e.lo[axis] < e.hi[axis])) return same_place(points, n);
    // The split need not be exactly in the middle, since cells need not be full.
    const float pivot = pivot_near(points, n, n / 2, axis);
    std::size_t left = partition_branchless(points, n, [=](const CutPoint& i) { return i.c[axis] < pivot; });
    if (left < n / 4 || left > n - n / 4) {
      left = whole_leaves(n);
      select(points, n, left, axis);
    }
    into_cells(points, left);
    into_cells(points + left, n - left);
  }

 private:
  static std::size_t whole_leaves(std::size_t n) { return (n / kLeafCapacity + 1) / 2 * kLeafCapacity; }

  void same_place(CutPoint* points, std::size_t n) {
    by_row(points, n);
    for (std::size_t done = 0; done < n; done += cell_points_) {
      begin_.push_back(begin_.back() + static_cast<std::uint32_t>(std::min<std::size_t>(cell_points_, n - done)));
    }
  }

  void by_row(CutPoint* points, std::size_t n) const {
    std::sort(points, points + n,
              [this](const CutPoint& a, const CutPoint& b) { return row_of_(a.index) < row_of_(b.index); });
  }

  const RowOf& row_of_;
  std::uint32_t cell_points_;
  std::vector<std::uint32_t>& begin_;
};

}  // namespace

void cut_into_cells(std::span<CutPoint> points, std::uint32_t cell_points, const RowOf& row_of,
                    std::vector<std::uint32_t>& begin) {
  assert(cell_points % kLeafCapacity == 0 && cell_points <= kCellCapacity && cell_points > 0);
  begin.assign(1, 0);
  if (!points.empty()) Cutter(row_of, cell_points, begin).into_cells(points.data(), points.size());
}

void cut(std::span<CutPoint> points, std::uint32_t cell_points, const RowOf& row_of,
         std::vector<std::uint32_t>& begin) {
  cut_into_cells(points, cell_points, row_of, begin);
  for (std::size_t c = 0; c + 1 < begin.size(); ++c)
    cut_into_leaves(points.subspan(begin[c], begin[c + 1] - begin[c]), row_of);
}

HWY_EXPORT(cut_cell);

void cut_into_leaves(std::span<CutPoint> points, const std::function<std::uint64_t(std::uint32_t)>& row_of) {
  if (points.size() <= kLeafCapacity) {
    const auto coincides = [&](const CutPoint& point) { return point.c == points[0].c; };
    if (std::ranges::all_of(points, coincides))
      std::ranges::sort(points, {}, [&](const CutPoint& point) { return row_of(point.index); });
    return;
  }
  HWY_DYNAMIC_DISPATCH(cut_cell)(points, row_of);
}

}  // namespace pointsweep
#endif
