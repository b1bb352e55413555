// SPDX-License-Identifier: MIT
/// Some points of the cloud in memory again, once the sweep is over.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/sweep/point_collector.h"
#include "pointsweep/sweep/slab_loader.h"
#include "pointsweep/sweep/window_cell.h"

namespace pointsweep {

/// Points come in by collect() and stay, in cells of their own; slots are 0, 1, ... and name the same cells for ever.
/// Only collect() changes the region, all else is thread-safe.
class Region : public CellSet {
 public:
  /// `frontier` comes from a sweep that has ended: it holds the boxes of all cells except superfluous cells.
  Region(const Stream& stream, const SlabLoader& loader, const Frontier& frontier, std::size_t slabs_at_once)
      : stream_(stream),
        loader_(loader),
        frontier_(frontier),
        slabs_at_once_(slabs_at_once),
        held_(stream.slabs().size()) {}

  /// Adds the wanted points that are not there yet. Returns false if these are more than `wanted` allows.
  bool collect(WantedPoints wanted);

  /// Returns whether the cells within sqrt(reach2) of `p` hold more than `count` points.
  bool touches_more_than(std::uint64_t count, Vec3 p, double reach2) const;
  /// Returns a squared distance from `p` within which at least `count` points lie; infinite if all cells hold fewer.
  double reach2_that_holds(Vec3 p, std::uint64_t count) const;

  const SlabsRead& slabs_read() const { return slabs_read_; }

 private:
  const Stream& stream_;
  const SlabLoader& loader_;
  const Frontier& frontier_;
  std::size_t slabs_at_once_;
  std::vector<std::vector<std::uint32_t>> held_;  ///< by slab: the places of its points in the region, ascending
  SlabsRead slabs_read_;
};

}  // namespace pointsweep
