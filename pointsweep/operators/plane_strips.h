// SPDX-License-Identifier: MIT
/// The nearest points in the plane of a set of points that does not fit in memory: strips across an axis, in scratch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/points/scratch.h"

namespace pointsweep {

/// A point of the set, with its squared distance from the one that is asked about.
struct PlaneNeighbor {
  double distance2;  ///< dx² + dy² in float64
  Vec3 position;
  std::uint64_t row;

  /// Nearest first; equal distances by x, y, z, row.
  bool operator<(const PlaneNeighbor& other) const;
};

class PlaneStrips {
 public:
  /// `axis`: 0 or 1; `memory_bytes`: for the strips that are in memory, of which there are a few in any case.
  PlaneStrips(int axis, std::uint64_t memory_bytes, std::unique_ptr<Scratch> scratch);
  /// Points come in ascending order along the axis.
  void add(Vec3 position, std::uint64_t row);
  /// After the last point.
  void finish();

  /// Loads the strips around these places along the axis, which may then be searched by many threads at once.
  void load(double from, double to);
  /// The k nearest of the set, or all, nearest first. False, and nothing found, if strips are needed that are not
  /// loaded. Reads nothing.
  bool find_loaded(Vec3 place, std::size_t k, std::vector<PlaneNeighbor>& found) const;
  /// Loads what it needs. For one thread at a time.
  void find(Vec3 place, std::size_t k, std::vector<PlaneNeighbor>& found);

  /// Memory of one strip.
  static std::uint64_t strip_bytes();

 private:
  struct Point {
    Vec3 position;
    std::uint64_t row;
  };
  struct Strip {
    double least, most;  ///< along the axis
    std::uint64_t first;
    std::size_t count;
  };
  using Points = std::vector<Point>;
  double along(Vec3 p) const { return axis_ == 0 ? p.x : p.y; }
  double across(Vec3 p) const { return axis_ == 0 ? p.y : p.x; }
  void end_strip();
  std::size_t strip_at(double along) const;
  const Points* loaded(std::size_t strip) const;
  const Points& loaded_now(std::size_t strip, std::size_t near);
  template <class GetStrip>
  bool search(Vec3 place, std::size_t k, std::vector<PlaneNeighbor>& found, GetStrip get_strip) const;
  void search_strip(const Points& points, Vec3 place, std::size_t k, std::vector<PlaneNeighbor>& found) const;
  static void take(const Point& point, Vec3 place, std::size_t k, std::vector<PlaneNeighbor>& found);

  int axis_;
  std::size_t most_loaded_;
  std::unique_ptr<Scratch> scratch_;
  std::vector<Strip> strips_;
  Points strip_;  ///< that grows
  std::uint64_t count_ = 0;
  std::map<std::size_t, Points> loaded_;
};

}  // namespace pointsweep
