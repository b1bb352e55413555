// SPDX-License-Identifier: MIT
/// Points and their neighbours in vector lanes, a point per lane, a tile of points at a time. Included once per
/// instruction set.
///
/// The data of a tile are first copied point by point into arrays, and later read as vectors: reading a vector right
/// after its numbers were written one by one would stall the processor.
#if defined(POINTSWEEP_OPERATORS_NEIGHBOR_TILES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef POINTSWEEP_OPERATORS_NEIGHBOR_TILES_INL_H_
#undef POINTSWEEP_OPERATORS_NEIGHBOR_TILES_INL_H_
#else
#define POINTSWEEP_OPERATORS_NEIGHBOR_TILES_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "pointsweep/math/eigen3_lanes-inl.h"
#include "pointsweep/neighborhood.h"

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {

using Lanes = hn::ScalableTag<double>;
using V = hn::Vec<Lanes>;
constexpr std::size_t kLanes = hn::MaxLanes(Lanes());
using FloatLanes = hn::Rebind<float, Lanes>;  // as many lanes as Lanes

/// One number for each lane.
struct LaneArray {
  HWY_ALIGN double of[kLanes];
};

constexpr std::size_t kTilePoints = 32;  // largest number of points of a tile
static_assert(kTilePoints % kLanes == 0 && kLanes <= 8);

/// Successive points of a batch. If none of the next 32 points has more than 16, 32 or 64 neighbours, a tile has up to
/// 32, 16 or 8 points, and holds all their neighbours. Otherwise a tile is one vector of points, and holds at most
/// kRoom / kLanes neighbours of each at a time.
struct Tile {
  static constexpr std::size_t kRoom = 512;

  const Neighborhoods& in;
  std::size_t first, size, vectors;
  std::size_t stride;  // distance in a NeighborArray between successive neighbours of a point
  std::size_t chunk;   // largest number of neighbours of a point that the tile holds at a time
  std::size_t most = 0;
  std::size_t count[kTilePoints];  // |N_i|, which Extents may set to 0; 0 after the end of the batch

  Tile(const Neighborhoods& in_, std::size_t first_, std::size_t end) : in(in_), first(first_) {
    for (std::size_t l = 0; l < kTilePoints; ++l) {
      count[l] = first + l < end ? in.count(first + l) : 0;
      most = std::max(most, count[l]);
    }
    stride = most <= 16 ? 32 : most <= 32 ? 16 : most <= 64 ? 8 : kLanes;
    size = std::min(stride, end - first);
    most = *std::max_element(count, count + size);
    vectors = (size + kLanes - 1) / kLanes;
    chunk = kRoom / stride;
  }
  /// Returns how many neighbours of each point the tile holds if it holds those from neighbour `from` on; it holds 0
  /// for each that a point lacks.
  std::size_t Held(std::size_t from) const { return std::min(chunk, most - from); }
  /// Returns the index in a NeighborArray of the c-th held neighbour, from c = 0, of the first point of a vector; the
  /// indices for the other points of the vector follow.
  std::size_t At(std::size_t vector, std::size_t c) const { return c * stride + vector * kLanes; }
};

/// One number for each point of a tile.
struct TileArray {
  HWY_ALIGN double of[kTilePoints];
  V Load(std::size_t vector) const { return hn::Load(Lanes(), of + vector * kLanes); }
};

/// Calls use() with a pointer to attribute `a` of a vector of points, a T per lane; `use` finds 0 after the last point
/// of the tile.
template <class T, class Use>
HWY_INLINE auto WithOwn(const Tile& tile, std::size_t a, std::size_t vector, const Use& use) {
  const std::size_t first = vector * kLanes, size = tile.size - first;
  const T* own = tile.in.values<T>(a) + tile.first + first;
  if (size >= kLanes) return use(own);
  T some[kLanes] = {};
  std::copy_n(own, size, some);
  return use(some);
}

/// Returns the values of attribute `a`, which is one float32, of a vector of points.
HWY_INLINE V OwnNumbers(const Tile& tile, std::size_t a, std::size_t vector) {
  return WithOwn<float>(tile, a, vector,
                        [](const float* own) HWY_ATTR { return hn::PromoteTo(Lanes(), hn::LoadU(FloatLanes(), own)); });
}

/// Returns the values of attribute `a`, which is three float32, of a vector of points.
HWY_INLINE Vec3Lanes<V> OwnVectors(const Tile& tile, std::size_t a, std::size_t vector) {
  return WithOwn<std::array<float, 3>>(tile, a, vector, [](const std::array<float, 3>* own) HWY_ATTR {
    hn::Vec<FloatLanes> x, y, z;
    hn::LoadInterleaved3(FloatLanes(), own->data(), x, y, z);
    const Lanes d;
    return Vec3Lanes<V>{hn::PromoteTo(d, x), hn::PromoteTo(d, y), hn::PromoteTo(d, z)};
  });
}

/// A value for each neighbour that a tile holds. The value of the c-th held neighbour of point l of the tile has the
/// index c * Tile::stride + l, with c and l from 0.
template <class T>
struct NeighborArray {
  HWY_ALIGN T of[Tile::kRoom];
};

/// Vectors of the neighbours that a tile holds, indexed as in a NeighborArray: of(i)(ref) for each neighbour `ref` of
/// each point i of the batch; 0 after a point's last neighbour.
template <class OfNeighbor>
class NeighborVectors {
 public:
  NeighborVectors(const Tile& tile, OfNeighbor of) : tile_(tile), of_(of) { Fetch(0); }
  /// Loads the vectors from neighbour `from` on, unless they are already loaded. Returns whether it has loaded them.
  HWY_INLINE bool Hold(std::size_t from) {
    if (from == from_) return false;
    Fetch(from);
    return true;
  }
  /// Returns the vectors of the c-th held neighbours of a vector of points.
  HWY_INLINE Vec3Lanes<V> Load(std::size_t vector, std::size_t c) const {
    const Lanes d;
    const std::size_t at = tile_.At(vector, c);
    return {hn::Load(d, x_ + at), hn::Load(d, y_ + at), hn::Load(d, z_ + at)};
  }
  HWY_INLINE void Store(const Vec3Lanes<V>& value, std::size_t vector, std::size_t c) {
    const Lanes d;
    const std::size_t at = tile_.At(vector, c);
    hn::Store(value.x, d, x_ + at), hn::Store(value.y, d, y_ + at), hn::Store(value.z, d, z_ + at);
  }
  /// Returns the vector of the c-th held neighbour of point l of the tile.
  Vec3 Of(std::size_t l, std::size_t c) const {
    const std::size_t at = c * tile_.stride + l;
    return {x_[at], y_[at], z_[at]};
  }
  /// Sets all held vectors of point l of the tile to 0.
  void Clear(std::size_t l) {
    for (std::size_t at = l; at < Tile::kRoom; at += tile_.stride) x_[at] = y_[at] = z_[at] = 0;
  }

 private:
  void Fetch(std::size_t from) {
    from_ = from;
    const std::size_t stride = tile_.stride, wanted = tile_.Held(from);
    for (std::size_t l = 0; l < tile_.vectors * kLanes; ++l) {
      const std::size_t k = tile_.count[l];
      const std::size_t have = std::min(wanted, k - std::min(from, k));
      std::size_t at = l;
      if (have > 0) {
        const NeighborRef* refs = tile_.in.neighbors(tile_.first + l) + from;
        const auto vector = of_(tile_.first + l);
        for (std::size_t c = 0; c < have; ++c, at += stride) {
          const Vec3 v = vector(refs[c]);
          x_[at] = v.x, y_[at] = v.y, z_[at] = v.z;
        }
      }
      for (std::size_t c = have; c < wanted; ++c, at += stride) x_[at] = y_[at] = z_[at] = 0;
    }
  }

  const Tile& tile_;
  OfNeighbor of_;
  std::size_t from_ = 0;
  HWY_ALIGN double x_[Tile::kRoom];
  HWY_ALIGN double y_[Tile::kRoom];
  HWY_ALIGN double z_[Tile::kRoom];
};

/// A function for NeighborVectors: returns p_j - p_i for a neighbour j of point i.
struct OffsetOf {
  const Neighborhoods& in;
  HWY_INLINE auto operator()(std::size_t i) const {
    return [this, p = in.position(i)](NeighborRef ref) HWY_ATTR { return in.position_of(ref) - p; };
  }
};
using Offsets = NeighborVectors<OffsetOf>;

/// Calls state.Include(offset) with the offsets of the first neighbours of a vector of points, then of the second ones,
/// and so on; offsets after a point's last neighbour are 0.
template <class State>
HWY_INLINE void ForNeighbors(const Tile& tile, Offsets& offsets, std::size_t vector, State& state) {
  for (std::size_t from = 0; from < tile.most; from += tile.chunk) {
    offsets.Hold(from);
    for (std::size_t c = 0; c < tile.Held(from); ++c) state.Include(offsets.Load(vector, c));
  }
}

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
