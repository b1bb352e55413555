// SPDX-License-Identifier: MIT
/// Scratches (points/scratch.h) in memory or in files, and points in them for repeated reads: all points of a cloud in
/// Morton order, and lists of some points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/levels/level_grid.h"
#include "pointsweep/points/scratch.h"

namespace pointsweep {

/// A source of scratches. A scratch lies in memory if its expected bytes fit in what the earlier ones have left of a
/// number of bytes, else in the temporary folder.
class ScratchRoom {
 public:
  /// Without `files`, all scratches are in memory.
  ScratchRoom(std::uint64_t memory_bytes, MakeScratch files) : memory_(memory_bytes), files_(std::move(files)) {}

  /// Makes a scratch for about `expected` bytes.
  std::unique_ptr<Scratch> make(std::uint64_t expected);
  bool has_files() const { return files_ != nullptr; }
  const MakeScratch& files() const { return files_; }

 private:
  std::uint64_t memory_;  ///< bytes that are left
  MakeScratch files_;
};

/// The points of a cloud in Morton order.
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
  /// Returns the box around the places (LevelGrid::place()) of the points of a block. Block b begins at point
  /// b * kBlockRows.
  Box block_box(std::uint64_t block) const;

 private:
  LevelGrid grid_;
  std::unique_ptr<Scratch> scratch_;
  std::uint64_t count_ = 0;
  std::vector<GridBounds> bounds_;  ///< bounds of each block
  std::vector<GridPoint> added_;
};

/// Lists of points, each written once.
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
