// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/copc_layout.h"

#include <algorithm>
#include <cstring>
#include <set>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/las/las_point_formats.h"

namespace pointsweep {
namespace {

/// Returns the sort key of nodes in a page and of their chunks in the file.
auto order_of(const Octant& octant) { return std::pair(octant.depth, first_key(octant)); }

/// Calls `use` with the offset and the value of each entry of the info VLR.
template <class Info, class Use>
void each_entry(Info& info, const Use& use) {
  use(0, info.center.x);
  use(8, info.center.y);
  use(16, info.center.z);
  use(24, info.half_size);
  use(32, info.spacing);
  use(40, info.root_offset);
  use(48, info.root_bytes);
  use(56, info.least_time);
  use(64, info.greatest_time);
}

void add_ancestors(std::vector<CopcNode>& nodes) {
  const auto less = [](const Octant& a, const Octant& b) { return order_of(a) < order_of(b); };
  std::set<Octant, decltype(less)> all(less);
  for (const CopcNode& node : nodes) all.insert(node.octant);
  const std::vector<Octant> own(all.begin(), all.end());
  for (Octant octant : own)
    while (octant.depth > 0) {
      octant = parent_of(octant);
      if (!all.insert(octant).second) break;
      nodes.push_back({octant});
    }
  if (all.empty()) nodes.push_back({});
}

}  // namespace

std::vector<std::byte> copc_info_bytes(const CopcInfo& info) {
  std::vector<std::byte> bytes(kCopcInfoBytes);
  each_entry(info, [&](std::size_t at, const auto& entry) { std::memcpy(&bytes[at], &entry, sizeof entry); });
  return bytes;
}

CopcInfo copc_info_of(std::span<const std::byte> bytes) {
  CopcInfo info;
  each_entry(info, [&](std::size_t at, auto& entry) { std::memcpy(&entry, &bytes[at], sizeof entry); });
  return info;
}

std::vector<std::byte> copc_hierarchy_bytes(std::vector<CopcNode> nodes) {
  add_ancestors(nodes);
  std::ranges::sort(nodes, {}, [](const CopcNode& node) { return order_of(node.octant); });
  std::vector<std::byte> bytes(nodes.size() * kCopcEntryBytes);
  std::byte* entry = bytes.data();
  for (const CopcNode& node : nodes) {
    std::memcpy(entry, &node.octant.depth, 4);
    std::memcpy(entry + 4, node.octant.at.data(), 12);
    std::memcpy(entry + 16, &node.offset, 8);
    std::memcpy(entry + 24, &node.bytes, 4);
    std::memcpy(entry + 28, &node.points, 4);
    entry += kCopcEntryBytes;
  }
  return bytes;
}

FileLayout copc_file_layout(const Schema& schema, FileLayout layout, const std::string& path) {
  if (layout.point_format && (*layout.point_format < 6 || *layout.point_format > 8))
    fail_usage("{}: COPC has the point formats 6, 7 and 8, not {}; state one of these, or write LAZ.", path,
               *layout.point_format);
  if (layout.las_version && *layout.las_version != 4)
    fail_usage("{}: COPC is LAS 1.4, not 1.{}; leave the version out, or write LAZ.", path, *layout.las_version);
  if (layout.point_format) return layout;
  const bool has_colors = schema.find("red") && schema.find("green") && schema.find("blue");
  layout.point_format = has_colors && schema.find("nir") ? 8 : has_colors ? 7 : 6;
  return layout;
}

}  // namespace pointsweep
