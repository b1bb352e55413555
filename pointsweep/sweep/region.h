// SPDX-License-Identifier: MIT
/// The region of a recall: points of the stream inside balls, which are read into memory again after the sweep. A
/// reading of the stream reads only the slabs that have a cell which a ball touches, or a needed place, each once.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "pointsweep/search/ball_lookup.h"
#include "pointsweep/sweep/frontier.h"
#include "pointsweep/sweep/slab_loader.h"
#include "pointsweep/sweep/window.h"

namespace pointsweep {

/// Place in the stream of a point that is collected even if it is a superfluous copy of another point.
struct NeededPlace {
  std::uint32_t slab, index_in_slab;
  auto operator<=>(const NeededPlace&) const = default;
};

/// The points to be collected, and the limit of their number.
struct WantedPoints {
  /// Balls of which only the points nearest to the center are needed: `nearest` points, and all other points as far
  /// away as the farthest of these.
  std::vector<Ball> balls = {};
  std::uint64_t nearest = 1;
  /// Balls of which all points are needed. Some points near the balls are collected, too. If many balls overlap,
  /// `whole_balls` take much less time than `balls`.
  std::vector<Ball> whole_balls = {};
  std::vector<NeededPlace> places = {};  ///< places of points that are needed even outside of all balls, ascending
  std::uint64_t most_points = 0;         ///< limit of the number of points; the search ends when it finds more
};

/// Points of one slab, and their records (Stream::record_schema()).
struct CollectedPoints {
  std::uint32_t slab;
  std::vector<std::uint32_t> index_in_slab;  ///< index of each point in the slab, ascending
  std::vector<std::byte> records;

  /// Drops the points for which is_kept(number) is false; numbers count the points from 0.
  template <class IsKept>
  void keep_only(const IsKept& is_kept) {
    if (index_in_slab.empty()) return;
    const std::size_t stride = records.size() / index_in_slab.size();
    std::size_t kept = 0;
    for (std::uint32_t i = 0; i < index_in_slab.size(); ++i) {
      if (!is_kept(i)) continue;
      index_in_slab[kept] = index_in_slab[i];
      std::memmove(records.data() + kept++ * stride, records.data() + i * stride, stride);
    }
    index_in_slab.resize(kept);
    records.resize(kept * stride);
  }
};

/// The number of slabs that were read, and the bytes of their records.
struct SlabsRead {
  std::uint64_t slabs = 0, bytes = 0;
  void add(const SlabsRead& more) { slabs += more.slabs, bytes += more.bytes; }
};

/// One reading of the stream that collects needed points. Superfluous points (see Frontier) are collected only for
/// `places`.
class PointCollector {
 public:
  /// `frontier` comes from a sweep that has ended: it holds the boxes of all cells except superfluous cells.
  PointCollector(const Stream& stream, const Frontier& frontier, WantedPoints wanted);

  /// Reads and searches slabs, `slabs_at_once` of them at once. Returns false if too many points are found.
  bool run(std::size_t slabs_at_once);
  /// Returns the collected points by slab, ascending.
  std::vector<CollectedPoints> take() { return std::move(found_); }
  const SlabsRead& slabs_read() const { return slabs_read_; }

 private:
  std::vector<std::uint32_t> touched_slabs() const;
  bool touches(const Ball& ball, std::uint32_t slab) const;
  bool is_needed(std::uint32_t slab) const;
  Ball ball_now(std::uint32_t number) const { return {wanted_.balls[number].center, reach2_of(number)}; }
  double reach2_of(std::uint32_t ball) const { return reach2_[ball].load(std::memory_order_relaxed); }
  void shrink(std::uint32_t ball, double d2);
  bool is_superfluous(Vec3 p, const std::byte* record) const;
  template <class IsInside>
  std::vector<std::uint32_t> numbers_of(std::span<const std::byte> records, const IsInside& is_inside) const;
  std::vector<std::uint32_t> numbers_inside(std::uint32_t slab, std::span<const std::byte> records, bool shrinks);
  CollectedPoints search(std::uint32_t slab, std::span<const std::byte> records);
  void drop_points_outside();

  const Stream& stream_;
  const Frontier& frontier_;
  WantedPoints wanted_;
  PositionFields position_;
  std::unique_ptr<std::atomic<double>[]> reach2_;  ///< current squared radius of each ball
  /// For each ball, a heap of the squared distances of the nearest points so far.
  std::vector<std::vector<double>> distances2_;
  BallCover cover_;
  std::array<std::mutex, 64> mutexes_;  ///< mutex i guards the heaps of the balls i, i + 64, ...
  std::vector<CollectedPoints> found_;
  std::uint64_t points_ = 0;
  SlabsRead slabs_read_;
};

/// The cells that a recall has read. collect() adds points, in new cells. A slot (0, 1, ...) refers to the same cell
/// during the lifetime of the region. All functions except collect() are thread-safe.
class Region : public CellSet {
 public:
  /// `frontier` comes from a completed sweep and holds the boxes of all cells that are not superfluous.
  Region(const Stream& stream, const SlabLoader& loader, const Frontier& frontier, std::size_t slabs_at_once)
      : stream_(stream),
        loader_(loader),
        frontier_(frontier),
        slabs_at_once_(slabs_at_once),
        held_(stream.slabs().size()) {}

  /// Adds the wanted points that the region does not hold yet. Returns false, and adds none, if the wanted points are
  /// more than WantedPoints::most_points.
  bool collect(WantedPoints wanted);

  /// Returns whether the cells of the stream within sqrt(reach2) of `p` hold more than `count` points. Superfluous
  /// cells do not count.
  bool touches_more_than(std::uint64_t count, Vec3 p, double reach2) const;
  /// Returns a squared distance from `p` within which at least `count` points of the stream lie; infinite if all cells
  /// together hold fewer. Superfluous cells do not count.
  double reach2_that_holds(Vec3 p, std::uint64_t count) const;

  const SlabsRead& slabs_read() const { return slabs_read_; }

 private:
  const Stream& stream_;
  const SlabLoader& loader_;
  const Frontier& frontier_;
  std::size_t slabs_at_once_;
  std::vector<std::vector<std::uint32_t>> held_;  ///< for each slab, indices of the points held, ascending
  SlabsRead slabs_read_;
};

}  // namespace pointsweep
