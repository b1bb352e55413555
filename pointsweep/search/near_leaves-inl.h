// SPDX-License-Identifier: MIT
/// Search for the leaves of a cell that are near a box, by the boxes of the leaves in single precision. Included once
/// per instruction set.
#if defined(POINTSWEEP_SEARCH_NEAR_LEAVES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTSWEEP_SEARCH_NEAR_LEAVES_INL_H_
#undef POINTSWEEP_SEARCH_NEAR_LEAVES_INL_H_
#else
#define POINTSWEEP_SEARCH_NEAR_LEAVES_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "pointsweep/search/cell.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace pointsweep {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// A leaf and its squared distance in one number, so that sorting the numbers sorts leaves by distance. Bits 32 to 63
/// hold the squared distance as a float, bits 8 to 31 the place of the cell in NearCells::cells, bits 0 to 7 the number
/// of the leaf in the cell.
struct NearLeaf {
  static std::uint64_t key(float distance2, std::size_t place, std::uint32_t leaf) {
    std::uint32_t bits;
    std::memcpy(&bits, &distance2, sizeof bits);
    return std::uint64_t{bits} << 32 | place << 8 | leaf;
  }
  static float distance2(std::uint64_t key) {
    const auto bits = static_cast<std::uint32_t>(key >> 32);
    float d2;
    std::memcpy(&d2, &bits, sizeof d2);
    return d2;
  }
  static std::size_t place(std::uint64_t key) { return (key >> 8) & 0xFFFFFF; }
  static std::uint32_t leaf(std::uint64_t key) { return key & 0xFF; }
};
static_assert(kCellCapacity / kLeafCapacity <= 256);

/// Returns a limit for the squared distances of leaves in single precision: a leaf whose squared distance exceeds the
/// limit is surely farther away than sqrt(reach2). The margin covers the rounding of the distances, even of denormal
/// distances.
inline float not_near(double reach2) { return static_cast<float>(reach2 * (1 + 1e-6)) + 0x1p-140f; }

/// Calls found(distance2, leaf) for all leaves of `cell` within sqrt(reach2) of `box`, and for some leaves slightly
/// farther away. distance2 is rounded to single precision; compare it only with not_near().
template <class Found>
HWY_INLINE void find_near_leaves(const Cell& cell, const Box& box, double reach2, Found found) {
  const hn::CappedTag<float, kLeafCapacity> d;
  using Vec = hn::Vec<decltype(d)>;
  // Single-precision bounds below and above v, which also cover the rounding of the difference that made v.
  const auto below = [](double v) { return round_down(v - std::abs(v) * 1e-14); };
  const auto above = [](double v) { return round_up(v + std::abs(v) * 1e-14); };
  const Vec3 lo = box.lo - cell.origin, hi = box.hi - cell.origin;
  const Vec lo_x = hn::Set(d, below(lo.x)), lo_y = hn::Set(d, below(lo.y)), lo_z = hn::Set(d, below(lo.z));
  const Vec hi_x = hn::Set(d, above(hi.x)), hi_y = hn::Set(d, above(hi.y)), hi_z = hn::Set(d, above(hi.z));
  const Vec zero = hn::Zero(d), limit = hn::Set(d, not_near(reach2));
  const float* const sides[6] = {cell.leaf_box[0], cell.leaf_box[1], cell.leaf_box[2],
                                 cell.leaf_box[3], cell.leaf_box[4], cell.leaf_box[5]};
  HWY_ALIGN float d2s[kLeafCapacity];
  for (std::uint32_t l = 0; l < cell.leaf_count(); l += static_cast<std::uint32_t>(hn::Lanes(d))) {
    const auto side = [&](int s) HWY_ATTR { return hn::Load(d, sides[s] + l); };
    const Vec dx = hn::Max(hn::Max(hn::Sub(side(0), hi_x), hn::Sub(lo_x, side(3))), zero);
    const Vec dy = hn::Max(hn::Max(hn::Sub(side(1), hi_y), hn::Sub(lo_y, side(4))), zero);
    const Vec dz = hn::Max(hn::Max(hn::Sub(side(2), hi_z), hn::Sub(lo_z, side(5))), zero);
    const Vec d2 = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)));
    const auto near = hn::Le(d2, limit);
    if (hn::AllFalse(d, near)) continue;
    hn::Store(d2, d, d2s);
    std::uint8_t mask[8] = {};
    hn::StoreMaskBits(d, near, mask);
    for (std::uint32_t bits = mask[0] | std::uint32_t{mask[1]} << 8; bits != 0; bits &= bits - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(bits));
      if (l + lane >= cell.leaf_count()) break;  // the boxes of padding are near only for an infinite reach
      found(d2s[lane], l + lane);
    }
  }
}

/// Collects the near leaves of all cells in `near` (in the order of CellDirectory::find) for which wanted(slot, leaf)
/// is true: writes their keys to `leaves`, nearest first. Ends early, with keys in no order, once there are more than
/// `most` keys.
template <class Wanted>
HWY_INLINE void collect_near_leaves(const CellDirectory& directory, const std::vector<CellDirectory::Near>& near,
                                    const Box& box, double reach2, std::size_t most, Wanted wanted,
                                    std::vector<std::uint64_t>& leaves) {
  leaves.clear();
  for (std::size_t n = 0; n < near.size() && near[n].distance2 <= reach2; ++n) {
    const Cell& cell = directory.cell(near[n].slot);
    if (distance2(cell.box, box) > reach2) continue;
    find_near_leaves(cell, box, reach2, [&](float d2, std::uint32_t leaf) HWY_ATTR {
      if (wanted(near[n].slot, leaf)) leaves.push_back(NearLeaf::key(d2, n, leaf));
    });
    if (leaves.size() > most) return;
  }
  std::sort(leaves.begin(), leaves.end());
}

}  // namespace HWY_NAMESPACE
}  // namespace pointsweep
HWY_AFTER_NAMESPACE();
#endif  // HWY_TARGET
#endif
