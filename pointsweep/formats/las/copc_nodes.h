// SPDX-License-Identifier: MIT
/// The nodes of a COPC file, made of points in Morton order. Each node becomes a chunk.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/formats/las/copc_layout.h"
#include "pointsweep/formats/las/laz_codec.h"
#include "pointsweep/levels/curve_key.h"
#include "pointsweep/points/scratch.h"

namespace pointsweep {

/// The least and the greatest GPS time.
struct TimeRange {
  double least = 0, greatest = 0;
};

/// Collects the points of nodes. One node of each depth is open at a time, since the points of a node are consecutive
/// on the Morton curve. The points of a node are compressed in the order of their GPS times, points of equal time in
/// the order of the curve. The threads compress several nodes at once.
class CopcNodes {
 public:
  /// `memory_bytes`: memory for the points of complete nodes that wait to be compressed. `most_node_bytes`: largest
  /// size of the points of one node. `aside` receives the compressed chunks.
  CopcNodes(const LazLayout& laz, std::size_t record_bytes, std::uint64_t memory_bytes, std::uint64_t most_node_bytes,
            std::unique_ptr<Scratch> aside, std::string path);

  /// Takes the next point: a record of point format 6, 7 or 8. Throws Error if its node has too many points.
  void add(const CurveKey& key, int depth, const std::byte* record);

  /// Returns the range of the GPS times of all points, without NaN; 0 and 0 if there is no such time.
  TimeRange times() const { return times_; }

  using Put = std::function<void(std::uint64_t at, std::span<const std::byte> bytes)>;
  /// Must be called after the last point. Puts the chunks of all nodes, by depth, then along the curve, from byte `at`
  /// on. Returns the nodes in the order of their chunks.
  std::vector<CopcNode> finish(std::uint64_t at, const Put& put);

 private:
  struct Waiting {
    Octant octant;
    std::vector<std::byte> records;
  };
  void close(int depth);
  void compress();
  void sort_by_time(std::vector<std::byte>& records) const;

  const LazLayout& laz_;
  std::size_t record_bytes_;
  std::uint64_t memory_, most_node_bytes_;
  std::unique_ptr<Scratch> aside_;
  std::string path_;
  std::array<std::vector<std::byte>, kMostDepth + 1> open_;  ///< the points of the open node of each depth
  CurveKey last_;
  std::vector<Waiting> waiting_;
  std::uint64_t waiting_bytes_ = 0, aside_bytes_ = 0;
  TimeRange times_;
  bool has_times_ = false;
  std::vector<CopcNode> nodes_;  ///< compressed nodes, with their offsets in aside_
};

}  // namespace pointsweep
