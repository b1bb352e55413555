// SPDX-License-Identifier: MIT
/// The parts of a COPC file that LAZ does not have: the info VLR and the hierarchy of nodes; and its choice of point
/// formats (https://copc.io).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/formats/las/las_reader.h"
#include "pointsweep/geometry.h"
#include "pointsweep/levels/curve_key.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Bytes of the content of the info VLR, of an entry of the hierarchy.
inline constexpr std::size_t kCopcInfoBytes = 160, kCopcEntryBytes = 32;

/// The content of the info VLR.
struct CopcInfo {
  Vec3 center;
  double half_size = 0;
  double spacing = 0;  ///< of the points of the root
  std::uint64_t root_offset = 0, root_bytes = 0;
  double least_time = 0, greatest_time = 0;
};
std::vector<std::byte> copc_info_bytes(const CopcInfo& info);
/// `bytes`: kCopcInfoBytes of them.
CopcInfo copc_info_of(std::span<const std::byte> bytes);

/// A node of the octree and its chunk in the file; without points the offset and the bytes are 0.
struct CopcNode {
  Octant octant;
  std::uint64_t offset = 0;
  std::uint32_t bytes = 0, points = 0;
};

/// Returns the content of the hierarchy record: one page, the nodes by depth, then along the curve. All ancestors of
/// the nodes are there.
std::vector<std::byte> copc_hierarchy_bytes(std::vector<CopcNode> nodes);

/// Returns the layout with a point format of COPC: the stated one, else 8 for near infrared, 7 for colours, 6 for all
/// others. Throws UsageError for a stated format or version that COPC does not have.
FileLayout copc_file_layout(const Schema& schema, FileLayout layout, const std::string& path);

}  // namespace pointsweep
