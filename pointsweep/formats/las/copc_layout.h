// SPDX-License-Identifier: MIT
/// The parts that a COPC file has beyond LAZ: the info VLR, the nodes, each of which is a chunk of points, the
/// hierarchy of the nodes, and the choice of point formats (COPC 1.0, https://copc.io).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/formats/las/las_reader.h"
#include "pointsweep/formats/las/laz_codec.h"
#include "pointsweep/geometry.h"
#include "pointsweep/levels/level_grid.h"
#include "pointsweep/math/box.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/points/scratch.h"
#include "pointsweep/storage/local/input_file.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Bytes of the content of the info VLR, and of an entry of the hierarchy.
inline constexpr std::size_t kCopcInfoBytes = 160, kCopcEntryBytes = 32;

/// The content of the info VLR in the layout of the file, without the reserved bytes at its end.
struct CopcInfo {
  Vec3 center;
  double half_size = 0;
  double spacing = 0;  ///< spacing of the points of the root node
  std::uint64_t root_offset = 0, root_bytes = 0;
  double least_time = 0, greatest_time = 0;
};
static_assert(sizeof(CopcInfo) == 72);
/// Returns the content of the info VLR with its reserved bytes.
std::vector<std::byte> copc_info_bytes(const CopcInfo& info);

/// A node of the octree and its chunk in the file. A node without points has offset and bytes 0.
struct CopcNode {
  Octant octant;
  std::uint64_t offset = 0;
  std::uint32_t bytes = 0, points = 0;
};

/// Returns the content of the hierarchy record: one page, nodes ordered by depth, then along the Morton curve. Missing
/// ancestors of the nodes are added as empty nodes.
std::vector<std::byte> copc_hierarchy_bytes(std::vector<CopcNode> nodes);

/// The octree nodes to which the chunks of a COPC file belong.
struct CopcChunks {
  /// Box and depth of the node of each chunk; empty if there are no nodes. Points of a chunk may lie outside of its
  /// box.
  std::vector<Box> boxes = {};
  std::vector<int> depths = {};
  double spacing = 0;  ///< spacing of the points of the root, as the file states it
};

/// Returns the nodes that the hierarchy assigns to the chunks of `points`; none if the hierarchy contradicts itself,
/// the chunk table or the file. In this case `why_not` states the reason as the end of a sentence. `info`: the byte
/// where the content of the info VLR begins. The pages that it reads have together at most as many bytes as the file.
CopcChunks read_copc_nodes(const InputFile& file, std::uint64_t info, const LazPoints& points, std::string& why_not);

/// Returns the layout with a point format that COPC allows: the stated point format, else 8 if there are colours and
/// near infrared, 7 if there are only colours, else 6. Throws UsageError for a stated format or version that COPC does
/// not allow.
FileLayout copc_file_layout(const Schema& schema, FileLayout layout, const std::string& path);

/// The least and the greatest GPS time of some points.
struct TimeRange {
  double least = 0, greatest = 0;
};

/// Collects the points of nodes. Points come in the order of the Morton curve, so that at most one node of each depth
/// is open, that is, may get more points. The points of a node are compressed in the order of their GPS times, points
/// of equal time in the order of the curve. The threads compress several nodes at once.
class CopcNodes {
 public:
  /// `memory_bytes`: memory for the points of complete nodes that wait to be compressed. `most_node_bytes`: largest
  /// number of bytes of the points of one node. `aside` holds the compressed chunks until finish().
  CopcNodes(const LazLayout& laz, std::size_t record_bytes, std::uint64_t memory_bytes, std::uint64_t most_node_bytes,
            std::unique_ptr<Scratch> aside, std::string path);

  /// Takes the next point: a record of point format 6, 7 or 8. Throws Error if its node has too many points.
  void add(const CurveKey& key, int depth, const std::byte* record);

  /// Returns the range of the GPS times of all points, without NaN; 0 and 0 if no point has a time.
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
