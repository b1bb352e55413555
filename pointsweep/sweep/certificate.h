// SPDX-License-Identifier: MIT
/// Which balls are certain to hold nothing unknown: neither a point not yet read nor one already dropped (Definition of
/// exactness, Section 2 of the design; the paper only looks ahead, Section 4.2.2).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/order/stream.h"

namespace pointsweep {

/// What lies outside the window: the boxes of the slabs still to come and of the cells that have left.
/// Changing it is the sweep's alone; asking is thread-safe.
class Outside {
 public:
  Outside(const std::vector<Slab>& slabs, int axis);

  std::size_t slabs_read() const { return read_; }
  void slab_was_read() { ++read_; }
  void cell_was_dropped(std::uint32_t slab, const Box& box);

  /// Whether a slab still to come lies within sqrt(reach2) of a box. Never once all are read, however far the reach.
  bool unread_within(const Box& box, double reach2) const;
  bool unread_within(Vec3 p, double reach2) const { return unread_within(Box{p, p}, reach2); }
  /// Boxes of dropped cells within sqrt(reach2) of a box.
  void dropped_near(const Box& box, double reach2, std::vector<Box>& out) const;

 private:
  const std::vector<Slab>& slabs_;
  int axis_;
  std::size_t read_ = 0;
  std::vector<std::uint32_t> dropping_slabs_;  ///< those with dropped cells
  std::vector<std::vector<Box>> dropped_;      ///< by slab
};

}  // namespace pointsweep
