// SPDX-License-Identifier: MIT
/// Stores from vector lanes, a point per lane, into the columns of a batch. Included once per instruction set.
#if defined(POINTSWEEP_OPERATORS_COLUMN_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTSWEEP_OPERATORS_COLUMN_LANES_INL_H_
#undef POINTSWEEP_OPERATORS_COLUMN_LANES_INL_H_
#else
#define POINTSWEEP_OPERATORS_COLUMN_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "pointsweep/operators/lanes/neighbor_tiles-inl.h"
#include "pointsweep/points/degenerate_points.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {

using FloatV = hn::Vec<FloatLanes>;

/// The points of the batch in one vector of a tile; empty for a vector after the last point of the tile. Lanes after
/// the last point belong to no point.
struct Points {
  std::size_t first, size;  // size: at most kLanes

  Points(const Tile& tile, std::size_t vector)
      : first(tile.first + std::min(vector * kLanes, tile.size)),
        size(std::min(kLanes, tile.first + tile.size - first)) {}

  /// Marks the points where the mask is false as degenerate.
  template <class M>
  HWY_INLINE void MarkWithout(M mask, DegeneratePoints& degenerate) const {
    const Lanes d;
    const auto without = hn::AndNot(mask, hn::FirstN(d, size));
    if (HWY_LIKELY(hn::AllFalse(d, without))) return;
    std::uint8_t bits[8];
    hn::StoreMaskBits(d, without, bits);
    for (std::size_t l = 0; l < size; ++l)
      if ((bits[l / 8] >> l % 8 & 1) != 0) degenerate.mark(first + l);
  }
};

/// Rounds to float. Numbers beyond the range of float become the nearest finite float. v must not be NaN.
HWY_INLINE FloatV Saturated(V v) {
  const V most = hn::Set(Lanes(), double(std::numeric_limits<float>::max()));
  return hn::DemoteTo(FloatLanes(), hn::Min(hn::Max(v, hn::Neg(most)), most));
}

/// Stores the numbers of a vector of points. An empty `column` is not wanted: this function, StoreTriples() and
/// StoreDirections() are then no-ops.
HWY_INLINE void StoreNumbers(V v, const Points& points, std::span<float> column) {
  if (column.empty()) return;
  const FloatLanes d;
  HWY_ALIGN float numbers[kLanes];
  if (points.size == kLanes) {
    hn::StoreU(Saturated(v), d, column.data() + points.first);
  } else {
    hn::Store(Saturated(v), d, numbers);
    std::copy_n(numbers, points.size, column.data() + points.first);
  }
}

HWY_INLINE void StoreTriples(FloatV a, FloatV b, FloatV c, const Points& points,
                             std::span<std::array<float, 3>> column) {
  if (column.empty()) return;
  if (points.size == kLanes) {
    hn::StoreInterleaved3(a, b, c, FloatLanes(), column[points.first].data());
    return;
  }
  HWY_ALIGN float lanes[3][kLanes];
  hn::Store(a, FloatLanes(), lanes[0]);
  hn::Store(b, FloatLanes(), lanes[1]);
  hn::Store(c, FloatLanes(), lanes[2]);
  for (std::size_t l = 0; l < points.size; ++l) column[points.first + l] = {lanes[0][l], lanes[1][l], lanes[2][l]};
}

/// Stores unit vectors of arbitrary sign, each with the sign that makes its component of largest magnitude, or the
/// first of several, positive; stores 0 where the mask is false. Adding 0 turns -0 into 0, so that results do not show
/// which vectors were negated.
template <class M>
HWY_INLINE void StoreDirections(M mask, const Vec3Lanes<V>& v, const Points& points,
                                std::span<std::array<float, 3>> column) {
  const FloatLanes d;
  const auto rounded = [&](V c) HWY_ATTR { return hn::DemoteTo(d, hn::IfThenElseZero(mask, c)); };
  const FloatV x = rounded(v.x), y = rounded(v.y), z = rounded(v.z), zero = hn::Zero(d);
  const FloatV of_xy = hn::IfThenElse(hn::Gt(hn::Abs(y), hn::Abs(x)), y, x);
  const FloatV largest = hn::IfThenElse(hn::Gt(hn::Abs(z), hn::Abs(of_xy)), z, of_xy);
  const FloatV sign = hn::CopySign(hn::Set(d, 1.0f), largest);
  StoreTriples(hn::Add(hn::Mul(x, sign), zero), hn::Add(hn::Mul(y, sign), zero), hn::Add(hn::Mul(z, sign), zero),
               points, column);
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
