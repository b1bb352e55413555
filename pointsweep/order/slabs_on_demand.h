// SPDX-License-Identifier: MIT
/// Slabs (stream.h) that are made from the input when they are read, without a distribution pass, and the number of
/// points that are decoded too early and wait in memory for their slabs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/order/local_spacing.h"
#include "pointsweep/order/pieces.h"
#include "pointsweep/order/source.h"
#include "pointsweep/order/working_record.h"
#include "pointsweep/points/row_box.h"

namespace pointsweep {

/// Rows that are decoded together, and the slabs that their points are in.
struct SlabBlock {
  std::uint64_t first_row = 0;
  std::uint32_t rows = 0;
  std::uint32_t first_slab = 0, last_slab = 0;
};

/// The slabs and their blocks, after all points have been counted.
struct CountedSlabs {
  std::vector<Splitters> splitters;          ///< one for all points, or one for dense and one for sparse places
  LocalSpacing spacing;                      ///< tells which places are sparse; used if there are two Splitters
  std::vector<std::uint32_t> slab_of_piece;  ///< ~0 for a piece without points
  std::vector<std::uint64_t> points;         ///< number of points of each slab
  std::vector<SlabBlock> blocks;             ///< ascending by first row; blocks without points are left out
};

/// Returns the largest number of points that are decoded and not yet returned in a slab, if up to `ahead` slabs at once
/// are read in order.
std::uint64_t most_waiting(const CountedSlabs& slabs, std::size_t ahead);

/// Returns the bytes of a memory block for the waiting points of a slab: small relative to the slab, so that little of
/// a slab with few waiting points is wasted.
std::size_t waiting_block_bytes(std::uint64_t slab_points, std::size_t record_bytes);

/// Slabs made while they are read in order: read() decodes a block of rows when the first slab with points of the block
/// is read; points of later slabs wait in memory. A second read of a slab decodes its blocks again, and makes
/// neighbouring slabs as well, as far as `most_points` allows, since the recall (sweep/recall.h) reads adjacent slabs.
class SlabsOnDemand {
 public:
  /// Copies `source`, which must have for_thread(), and borrows `record`. `wanted`: the source fields that working
  /// records contain; empty: all. At most `ahead` slabs are read in order at the same time; a read of a later slab
  /// decodes the blocks of that slab separately.
  SlabsOnDemand(const PointSource& source, const WorkingRecord& record, std::vector<std::size_t> wanted, int axis,
                CountedSlabs slabs, std::size_t ahead, std::uint64_t most_points);
  ~SlabsOnDemand();

  /// Fills `out` with all working records of a slab, ascending by row. Thread-safe. Throws Error if the source has
  /// changed since its points were counted.
  void read(std::size_t slab, std::span<std::byte> out);

 private:
  class State;
  std::unique_ptr<State> state_;
};

/// Estimates the largest number of points that are decoded and not yet returned in a slab. Assumes that all rows of a
/// box are decoded when the slabs being made reach the begin of the box along the axis. `ahead` slabs of `slab_points`
/// points are made at once; quantiles of `sample` tell where slabs end. The result is at most `points`.
std::uint64_t estimate_waiting(std::span<const RowBox> boxes, int axis, std::span<const Vec3> sample,
                               std::uint64_t points, std::uint64_t slab_points, std::size_t ahead);

}  // namespace pointsweep
