// SPDX-License-Identifier: MIT
/// Search for the neighbours of a group of points, the queries, one query per vector lane, among the points of the
/// leaves around the group. Included once per instruction set.
#if defined(POINTSWEEP_SEARCH_LEAF_QUERY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTSWEEP_SEARCH_LEAF_QUERY_INL_H_
#undef POINTSWEEP_SEARCH_LEAF_QUERY_INL_H_
#else
#define POINTSWEEP_SEARCH_LEAF_QUERY_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "pointsweep/search/cell.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace pointsweep {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, kLeafCapacity>;
using Vec = hn::Vec<Lanes>;

/// A key is a squared distance in single precision whose lowest bits are replaced by the number of the candidate, so
/// that the selection of the nearest candidates needs only min and max.
inline constexpr std::uint32_t kCandidateBits = 10;
inline constexpr std::uint32_t kCandidates = 1u << kCandidateBits;
inline constexpr float kEmptyKey = 1e30f;      ///< key of an empty entry
inline constexpr float kPadding = 1e16f;       ///< coordinate of padding: its key is above kEmptyKey
inline constexpr float kFarthest = 1e14f;      ///< limit to which coordinates are clamped: keys stay below kEmptyKey
inline constexpr float kSmallest = 0x1p-100f;  ///< added to every squared distance, so that keys are normal numbers

/// Bounds of the difference between a key and the squared distance d² in double, if all coordinates are at most m from
/// the centre:
///   |key - d²| <= 2^-12.4 d² + 2^-30 m²
/// from rounding to single precision (error e of 2^-24 m per coordinate; the mixed term 2d·e is at most 2^-14 d² + 2^14
/// e²) and from the 10 bits taken by the candidate's number (2^-13). Twice that, rounded up, separates two keys with
/// certainty.
inline constexpr float kRelativeMargin = 0x1p-11f;
inline constexpr float kAbsoluteMargin = 0x1p-28f;

HWY_INLINE void exchange(Vec& lower, Vec& upper) {
  const Vec least = hn::Min(lower, upper);
  upper = hn::Max(lower, upper);
  lower = least;
}

/// The comparisons of Batcher's odd-even merge sort of sixteen keys.
struct Comparators {
  static constexpr std::size_t kCount = 63;
  std::uint8_t lower[kCount] = {}, upper[kCount] = {};
  constexpr Comparators() {
    std::size_t n = 0;
    for (unsigned p = 1; p < 16; p *= 2) {
      for (unsigned q = p; q > 0; q /= 2) {
        for (unsigned j = q % p; j + q < 16; j += 2 * q) {
          for (unsigned i = j; i < j + q && i + q < 16; ++i) {
            if (i / (2 * p) != (i + q) / (2 * p)) continue;
            lower[n] = static_cast<std::uint8_t>(i), upper[n] = static_cast<std::uint8_t>(i + q);
            ++n;
          }
        }
      }
    }
  }
};
inline constexpr Comparators kComparators;

/// Sorts sixteen keys per lane.
HWY_INLINE void sort_sixteen(Vec (&keys)[kLeafCapacity]) {
  [&]<std::size_t... C>(std::index_sequence<C...>) HWY_ATTR {
    (exchange(keys[kComparators.lower[C]], keys[kComparators.upper[C]]), ...);
  }
  (std::make_index_sequence<Comparators::kCount>());
}

/// Sorts a bitonic list of N keys per lane, which are `stride` apart, by a bitonic merge in registers.
template <std::size_t N>
HWY_INLINE void merge_bitonic(Vec* keys, std::size_t stride) {
  Vec v[N];
  for (std::size_t i = 0; i < N; ++i) v[i] = keys[i * stride];
  for (std::size_t half = N / 2; half > 0; half /= 2) {
    for (std::size_t i = 0; i < N; ++i) {
      if ((i & half) == 0) exchange(v[i], v[i + half]);
    }
  }
  for (std::size_t i = 0; i < N; ++i) keys[i * stride] = v[i];
}

/// The K + 1 smallest keys per lane, ascending. If k < K, the first K - k places are always -1.
template <std::size_t K>
struct Selection {
  /// With at least this many keys, sorting sixteen keys and merging them is cheaper than inserting them one by one.
  static constexpr std::size_t kMergeFrom = K >= 32 ? 6 : kLeafCapacity + 1;
  Vec list[K + 1];

  HWY_INLINE void start(Lanes d, std::size_t k) {
    for (std::size_t i = 0; i <= K; ++i) list[i] = hn::Set(d, i + k < K ? -1.0f : kEmptyKey);
  }
  HWY_INLINE void insert(Vec key) {
    for (std::size_t i = K; i > 0; --i) list[i] = hn::Max(list[i - 1], hn::Min(list[i], key));
    list[0] = hn::Min(list[0], key);
  }
  /// Takes sixteen keys at once. The smaller elements of two ascending lists, one of them reversed, form a bitonic
  /// list. The smallest of the excluded keys becomes the new last key.
  HWY_INLINE void merge(Vec (&keys)[kLeafCapacity]) {
    static_assert(K % kLeafCapacity == 0 && K <= 64);
    sort_sixteen(keys);
    for (std::size_t i = 0; i < kLeafCapacity; ++i) {
      Vec& mine = list[K - kLeafCapacity + i];
      Vec& other = keys[kLeafCapacity - 1 - i];
      exchange(mine, other);
      list[K] = hn::Min(list[K], other);
    }
    for (std::size_t i = 0; i < 8; ++i) merge_bitonic<K / 8>(list + i, 8);
    for (std::size_t i = 0; i < K; i += 8) merge_bitonic<8>(list + i, 1);
  }
};

/// The candidates, leaf after leaf, in single precision and in the frame of the queries (struct Frame).
struct Packed {
  HWY_ALIGN float x[kCandidates];
  HWY_ALIGN float y[kCandidates];
  HWY_ALIGN float z[kCandidates];
  NeighborRef first[kCandidates / kLeafCapacity];  ///< first point of each packed leaf
  std::uint32_t leaves = 0;
  float farthest = 0;  ///< largest absolute coordinate, which is m in the bound of kAbsoluteMargin

  bool full() const { return leaves == kCandidates / kLeafCapacity; }
};

/// The box of a leaf in the frame of the queries.
struct LocalBox {
  float lo[3], hi[3];
  float farthest() const {
    float m = 0;
    for (int a = 0; a < 3; ++a) m = std::max({m, std::abs(lo[a]), std::abs(hi[a])});
    return m;
  }
};

/// The frame of a group of queries: coordinates relative to `center`, times a power of two that makes the leaf of the
/// queries about 1 wide.
struct Frame {
  Vec3 center;
  double scale;
  double unscale2;  ///< 1 / scale²

  LocalBox local(const Cell& cell, std::uint32_t leaf) const {
    const Vec3 shift = cell.origin - center;
    LocalBox b;
    for (int a = 0; a < 3; ++a) {
      const float lo = static_cast<float>((double{cell.leaf_box[a][leaf]} + shift[a]) * scale);
      const float hi = static_cast<float>((double{cell.leaf_box[a + 3][leaf]} + shift[a]) * scale);
      const float slack = 0x1p-21f * std::max(std::abs(lo), std::abs(hi));
      b.lo[a] = lo - slack, b.hi[a] = hi + slack;
    }
    return b;
  }
};

HWY_INLINE Vec to_local(Lanes d, const double* c, double center, double scale) {
  const hn::Rebind<double, hn::Half<Lanes>> dd;
  const hn::Half<Lanes> half;
  const auto o = hn::Set(dd, center);
  const auto s = hn::Set(dd, scale);
  const auto lower = hn::DemoteTo(half, hn::Mul(hn::Sub(hn::LoadU(dd, c), o), s));
  const auto upper = hn::DemoteTo(half, hn::Mul(hn::Sub(hn::LoadU(dd, c + hn::Lanes(dd)), o), s));
  const Vec v = hn::Combine(d, upper, lower);
  return hn::Max(hn::Min(v, hn::Set(d, kFarthest)), hn::Set(d, -kFarthest));
}

HWY_INLINE void pack(const Frame& frame, const Cell& cell, std::uint32_t slot, std::uint32_t leaf, float farthest,
                     Packed& packed) {
  const Lanes d;
  const std::size_t from = leaf * kLeafCapacity, to = packed.leaves * kLeafCapacity;
  for (std::size_t i = 0; i < kLeafCapacity; i += hn::Lanes(d)) {
    hn::Store(to_local(d, cell.x + from + i, frame.center.x, frame.scale), d, packed.x + to + i);
    hn::Store(to_local(d, cell.y + from + i, frame.center.y, frame.scale), d, packed.y + to + i);
    hn::Store(to_local(d, cell.z + from + i, frame.center.z, frame.scale), d, packed.z + to + i);
  }
  for (std::size_t i = cell.leaf_size(leaf); i < kLeafCapacity; ++i) packed.x[to + i] = kPadding;
  packed.first[packed.leaves++] = make_ref(slot, static_cast<std::uint32_t>(from));
  packed.farthest = std::max(packed.farthest, farthest);
}

/// In the leaf packed last, replaces points with a coordinate beyond ±`reach` by padding. Otherwise one leaf with
/// outliers, whose box is huge, would reduce the precision for all other leaves.
HWY_INLINE void leave_out_beyond(float reach, float farthest_of_others, Packed& packed) {
  const std::size_t first = (packed.leaves - 1) * kLeafCapacity;
  packed.farthest = farthest_of_others;
  for (std::size_t i = first; i < first + kLeafCapacity; ++i) {
    const float m = std::max({std::abs(packed.x[i]), std::abs(packed.y[i]), std::abs(packed.z[i])});
    if (m > reach)
      packed.x[i] = kPadding;
    else
      packed.farthest = std::max(packed.farthest, m);
  }
}

/// A group of queries, one per lane, and the nearest candidates found so far.
template <std::size_t K>
struct Group {
  Vec x, y, z;
  Vec radius_key;  ///< keys above this key are outside of the radius of the query
  Selection<K> selection;

  HWY_INLINE Vec key_of(Lanes d, const Packed& packed, std::size_t i,
                        hn::Vec<hn::RebindToUnsigned<Lanes>> number) const {
    const hn::RebindToUnsigned<Lanes> du;
    const Vec dx = hn::Sub(hn::Set(d, packed.x[i]), x);
    const Vec dy = hn::Sub(hn::Set(d, packed.y[i]), y);
    const Vec dz = hn::Sub(hn::Set(d, packed.z[i]), z);
    const Vec d2 = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::MulAdd(dz, dz, hn::Set(d, kSmallest))));
    return hn::BitCast(d, hn::OrAnd(number, hn::BitCast(du, d2), hn::Set(du, ~(kCandidates - 1))));
  }

  /// Tries the candidates of the last packed leaf.
  HWY_INLINE void try_last_leaf(Lanes d, const Packed& packed) {
    const hn::RebindToUnsigned<Lanes> du;
    const std::size_t first = (packed.leaves - 1) * kLeafCapacity;
    const Vec limit = hn::Min(selection.list[K], radius_key);
    // The first loop computes all keys and finds the candidates that any query needs; only these candidates are
    // inserted. So the processor may mispredict one branch instead of sixteen.
    HWY_ALIGN float keys[kLeafCapacity * hn::MaxLanes(Lanes())];
    std::uint32_t wanted = 0;
    for (std::size_t j = 0; j < kLeafCapacity; ++j) {
      const Vec key = key_of(d, packed, first + j, hn::Set(du, static_cast<std::uint32_t>(first + j)));
      hn::Store(key, d, keys + j * hn::Lanes(d));
      wanted |= std::uint32_t{!hn::AllFalse(d, hn::Lt(key, limit))} << j;
    }
    if constexpr (Selection<K>::kMergeFrom <= kLeafCapacity) {
      if (static_cast<std::size_t>(__builtin_popcount(wanted)) >= Selection<K>::kMergeFrom) {
        Vec all[kLeafCapacity];
        const Vec beyond = hn::Set(d, kEmptyKey);
        for (std::size_t j = 0; j < kLeafCapacity; ++j) {
          const Vec key = hn::Load(d, keys + j * hn::Lanes(d));
          all[j] = hn::IfThenElse(hn::Gt(key, radius_key), beyond, key);
        }
        return selection.merge(all);
      }
    }
    if (wanted == 0) return;
    Selection<K> best = selection;  // a local copy stays in registers
    for (; wanted != 0; wanted &= wanted - 1) {
      best.insert(hn::Load(d, keys + static_cast<std::size_t>(__builtin_ctz(wanted)) * hn::Lanes(d)));
    }
    selection = best;
  }

  /// Tries the candidates of the last packed leaf, which is the leaf of the queries; the first query is point
  /// `first_query` of the leaf. A point is not its own neighbour.
  HWY_INLINE void try_own_leaf(Lanes d, const Packed& packed, std::size_t first_query) {
    const hn::RebindToUnsigned<Lanes> du;
    const auto lane = hn::Add(hn::Iota(du, 0), hn::Set(du, static_cast<std::uint32_t>(first_query)));
    const std::size_t first = (packed.leaves - 1) * kLeafCapacity;
    const auto key_but_own = [&](std::size_t j) HWY_ATTR {
      const auto number = hn::Set(du, static_cast<std::uint32_t>(first + j));
      const auto self = hn::RebindMask(d, hn::Eq(lane, hn::Set(du, static_cast<std::uint32_t>(j))));
      return hn::IfThenElse(self, hn::Set(d, kEmptyKey), key_of(d, packed, first + j, number));
    };
    if constexpr (Selection<K>::kMergeFrom <= kLeafCapacity) {
      Vec all[kLeafCapacity];
      for (std::size_t j = 0; j < kLeafCapacity; ++j) all[j] = key_but_own(j);
      selection.merge(all);
    } else {
      Selection<K> best = selection;
      for (std::size_t j = 0; j < kLeafCapacity; ++j) best.insert(key_but_own(j));
      selection = best;
    }
  }

  /// Returns for each lane an upper bound of the squared distance at which the neighbourhood ends; kEmptyKey or more if
  /// that distance is unknown.
  HWY_INLINE Vec reach(Lanes d, float farthest) const {
    const Vec margin = hn::Set(d, farthest * farthest * kAbsoluteMargin);
    const Vec kth = selection.list[K - 1];
    return hn::Min(hn::MulAdd(kth, hn::Set(d, 1 + kRelativeMargin), margin), radius_key);
  }

  HWY_INLINE bool anyone_reaches(Lanes d, const LocalBox& b, Vec limit) const {
    const Vec zero = hn::Zero(d);
    const Vec dx = hn::Max(hn::Max(hn::Sub(hn::Set(d, b.lo[0]), x), hn::Sub(x, hn::Set(d, b.hi[0]))), zero);
    const Vec dy = hn::Max(hn::Max(hn::Sub(hn::Set(d, b.lo[1]), y), hn::Sub(y, hn::Set(d, b.hi[1]))), zero);
    const Vec dz = hn::Max(hn::Max(hn::Sub(hn::Set(d, b.lo[2]), z), hn::Sub(z, hn::Set(d, b.hi[2]))), zero);
    const Vec d2 = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)));
    return !hn::AllFalse(d, hn::Le(d2, limit));
  }
};

/// Returns a number with one bit for each lane of the mask.
HWY_INLINE std::uint32_t bits_of(Lanes d, hn::Mask<Lanes> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8;
}

/// Writes to `numbers` the numbers of the packed candidates within sqrt(reach2) of a place, and returns how many there
/// are.
HWY_INLINE std::size_t packed_within(Lanes d, const Packed& packed, Vec x, Vec y, Vec z, float reach2,
                                     std::uint16_t* numbers) {
  const Vec limit = hn::Set(d, reach2);
  std::size_t near = 0;
  for (std::uint32_t i = 0; i < packed.leaves * kLeafCapacity; i += static_cast<std::uint32_t>(hn::Lanes(d))) {
    const Vec dx = hn::Sub(hn::Load(d, packed.x + i), x), dy = hn::Sub(hn::Load(d, packed.y + i), y);
    const Vec dz = hn::Sub(hn::Load(d, packed.z + i), z);
    const Vec d2 = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)));
    for (std::uint32_t bits = bits_of(d, hn::Le(d2, limit)); bits != 0; bits &= bits - 1)
      numbers[near++] = static_cast<std::uint16_t>(i + static_cast<std::uint32_t>(__builtin_ctz(bits)));
  }
  return near;
}

}  // namespace HWY_NAMESPACE
}  // namespace pointsweep
HWY_AFTER_NAMESPACE();
#endif  // HWY_TARGET
#endif
