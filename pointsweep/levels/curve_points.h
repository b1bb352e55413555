// SPDX-License-Identifier: MIT
/// The points of a cloud in Morton order, for repeated reads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/levels/level_grid.h"
#include "pointsweep/levels/scratch_room.h"
#include "pointsweep/points/scratch.h"

namespace pointsweep {

class CurvePoints {
 public:
  /// Number of points that share one bounding box.
  static constexpr std::uint64_t kBlockRows = 4096;

  CurvePoints(const LevelGrid& grid, std::uint64_t count, ScratchRoom& room)
      : grid_(grid), scratch_(room.make(count * sizeof(GridPoint))) {}

  /// Appends the points with which the records begin.
  void add(std::span<const std::byte> records, std::size_t record_bytes);

  const LevelGrid& grid() const { return grid_; }
  std::uint64_t count() const { return count_; }
  /// Fills `points` with the points from number `first` on. Thread-safe, like all functions below.
  void read(std::uint64_t first, std::span<GridPoint> points) const;
  /// Returns a box around the points of a block, which begins at number block * kBlockRows.
  Box block_box(std::uint64_t block) const;

 private:
  LevelGrid grid_;
  std::unique_ptr<Scratch> scratch_;
  std::uint64_t count_ = 0;
  std::vector<GridBounds> bounds_;  ///< bounds of each block
  std::vector<GridPoint> added_;
};

}  // namespace pointsweep
