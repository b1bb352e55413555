// SPDX-License-Identifier: MIT
/// The parts that a COPC file has beyond LAZ: the info VLR, the hierarchy of nodes and the choice of point formats
/// (COPC 1.0, https://copc.io).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pointsweep/formats/las/las_reader.h"
#include "pointsweep/formats/las/laz_codec.h"
#include "pointsweep/geometry.h"
#include "pointsweep/levels/curve_key.h"
#include "pointsweep/math/box.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/storage/local/input_file.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Bytes of the content of the info VLR, and of an entry of the hierarchy.
inline constexpr std::size_t kCopcInfoBytes = 160, kCopcEntryBytes = 32;

/// The content of the info VLR, as it is stored; reserved bytes follow it.
struct CopcInfo {
  Vec3 center;
  double half_size = 0;
  double spacing = 0;  ///< spacing of the points of the root
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

/// The octree nodes of the chunks of a COPC file.
struct CopcChunks {
  /// Box and depth of the node of each chunk; empty if there are no nodes. Points of a chunk may lie outside of its
  /// box.
  std::vector<Box> boxes = {};
  std::vector<int> depths = {};
  double spacing = 0;  ///< spacing of the root, as the file states it
};

/// Returns the nodes that the hierarchy assigns to the chunks of `points`; none if the hierarchy contradicts itself,
/// the chunk table or the file. In this case `why_not` states the reason as the end of a sentence. `info`: the byte
/// where the content of the info VLR begins. Reads at most as many bytes as the file has.
CopcChunks read_copc_nodes(const InputFile& file, std::uint64_t info, const LazPoints& points, std::string& why_not);

/// Returns the layout with a point format that COPC allows: the stated point format, else 8 if there are colours and
/// near infrared, 7 if there are only colours, else 6. Throws UsageError for a stated format or version that COPC does
/// not allow.
FileLayout copc_file_layout(const Schema& schema, FileLayout layout, const std::string& path);

}  // namespace pointsweep
