// SPDX-License-Identifier: MIT
/// Lists of points in a scratch, written once and read several times.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/levels/level_grid.h"
#include "pointsweep/points/scratch.h"

namespace pointsweep {

class PointLists {
 public:
  struct List {
    std::uint64_t first = 0, count = 0;
    friend bool operator==(const List&, const List&) = default;
  };
  explicit PointLists(std::unique_ptr<Scratch> scratch) : scratch_(std::move(scratch)) {}

  List add(std::span<const GridPoint> points) {
    const List list{count_, points.size()};
    scratch_->append(std::as_bytes(points));
    count_ += points.size();
    return list;
  }
  /// Reads a list. Several threads may read at once.
  std::vector<GridPoint> read(const List& list) const {
    std::vector<GridPoint> points(static_cast<std::size_t>(list.count));
    if (list.count > 0) scratch_->read(list.first * sizeof(GridPoint), std::as_writable_bytes(std::span(points)));
    return points;
  }

 private:
  std::unique_ptr<Scratch> scratch_;
  std::uint64_t count_ = 0;
};

}  // namespace pointsweep
