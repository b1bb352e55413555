// SPDX-License-Identifier: MIT
/// Part of the cloud in memory: the cells around some points, read from the stream again once the sweep is over.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/search/directory.h"
#include "pointsweep/sweep/frontier.h"
#include "pointsweep/sweep/slab_loader.h"

namespace pointsweep {

/// Where points of one cell need everything: balls around them, and what holds all the balls.
struct NeededBalls {
  struct Ball {
    Vec3 center;
    double reach2;
  };
  Box centers;
  double reach2 = 0;  ///< the largest
  std::vector<Ball> balls;

  void add(Vec3 center, double ball_reach2);
  bool touch(const Box& box) const;
};

/// A place in the stream that must be in memory, even if its cell holds only superfluous copies.
struct NeededPlace {
  std::uint32_t slab, index_in_slab;
  auto operator<=>(const NeededPlace&) const = default;
};

/// Cells come in by load() and stay; a slot names the same cell for ever. Only load() changes the region, all else is
/// thread-safe.
class Region {
 public:
  /// `frontier`: of a sweep that has come to its end, so that it holds every cell of the cloud but superfluous ones.
  Region(const Stream& stream, const SlabLoader& loader, const Frontier& frontier, std::size_t slabs_at_once)
      : stream_(stream),
        loader_(loader),
        frontier_(frontier),
        slabs_at_once_(slabs_at_once),
        present_(stream.slabs().size()) {}

  /// Loads the cells that the balls touch and those of `places`, which ascend; reads a slab at most once. Stops early,
  /// and returns false, when the region holds more than `most_points`.
  bool load(std::span<const NeededBalls> balls, std::span<const NeededPlace> places, std::uint64_t most_points);

  /// The boxes of cells that are not in memory and hold something within sqrt(reach2) of `box`.
  void missing_near(const Box& box, double reach2, std::vector<Box>& out) const;
  /// The least squared distance within which cells begin that hold `count` points together; infinite if all cells hold
  /// fewer. Not all of these points are as near.
  double reach2_of_cells(Vec3 p, std::uint64_t count) const;

  const CellDirectory& directory() const { return directory_; }
  const PointColumns* slots() const { return views_.data(); }
  WindowCell& at(std::uint32_t slot) { return *cells_[slot]; }
  const WindowCell& at(std::uint32_t slot) const { return *cells_[slot]; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(cells_.size()); }  ///< cells; slots are 0, 1, ...
  std::uint64_t points() const { return points_; }
  std::uint64_t slabs_read() const { return slabs_read_; }

 private:
  bool is_present(std::uint32_t slab, std::uint32_t number) const {
    return number < present_[slab].size() && present_[slab][number];
  }
  /// What is to be read of a slab.
  struct MissingCells {
    std::uint32_t slab;
    std::vector<std::uint32_t> numbers;   ///< ascending
    std::span<const NeededPlace> places;  ///< in it, each in one of these cells or in another
  };
  std::vector<MissingCells> missing_cells(std::span<const NeededBalls> balls,
                                          std::span<const NeededPlace> places) const;
  LoadedSlab read(const MissingCells& missing) const;
  void admit(std::unique_ptr<WindowCell> cell);

  const Stream& stream_;
  const SlabLoader& loader_;
  const Frontier& frontier_;
  std::size_t slabs_at_once_;
  std::vector<std::vector<bool>> present_;  ///< by slab and number
  std::vector<std::unique_ptr<WindowCell>> cells_;
  std::vector<PointColumns> views_;
  CellDirectory directory_;
  std::uint64_t points_ = 0, slabs_read_ = 0;
};

}  // namespace pointsweep
