// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/copc_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <set>
#include <span>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/las/las_point_formats.h"

namespace pointsweep {
namespace {

constexpr std::size_t kReadEntries = 1024;
constexpr std::int32_t kIsPage = -1;  ///< count of points of an entry that refers to another page

/// Returns the sort key of nodes in a page and of their chunks in the file.
auto order_of(const Octant& octant) { return std::pair(octant.depth, first_key(octant)); }

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

/// An entry of the hierarchy, as it is stored.
struct Entry {
  std::int32_t level, x, y, z;
  std::uint64_t offset;
  std::int32_t bytes, points;
};
static_assert(sizeof(Entry) == kCopcEntryBytes);

/// Reads the hierarchy of a file, which assigns an octree node, and so a box, to each chunk of points.
class Hierarchy {
 public:
  Hierarchy(const InputFile& file, const CopcInfo& info, const LazPoints& points)
      : file_(file),
        info_(info),
        points_(points),
        nodes_{std::vector<Box>(points.chunks()), std::vector<int>(points.chunks()), info.spacing} {}

  /// Reads all pages. Returns an empty text, or the reason why the hierarchy cannot be used.
  std::string read() {
    const Vec3 half{info_.half_size, info_.half_size, info_.half_size};
    const bool is_cube = info_.half_size > 0 && is_finite(info_.center - half) && is_finite(info_.center + half);
    if (!is_cube || !std::isfinite(2 * info_.half_size)) return "its cube has no size";
    pages_.emplace_back(info_.root_offset, info_.root_bytes);
    while (!pages_.empty() && why_not_.empty()) {
      const auto [offset, bytes] = pages_.back();
      pages_.pop_back();
      read_page(offset, bytes);
    }
    if (!why_not_.empty()) return why_not_;
    for (std::size_t chunk = 0; chunk < nodes_.boxes.size(); ++chunk)
      if (nodes_.boxes[chunk].empty())
        return fmt::format("it names no node for chunk {} of {}", chunk + 1, nodes_.boxes.size());
    return "";
  }

  CopcChunks nodes() && { return std::move(nodes_); }

 private:
  void read_page(std::uint64_t offset, std::uint64_t bytes) {
    if (bytes == 0 || bytes % kCopcEntryBytes != 0 || offset > file_.size() || bytes > file_.size() - offset)
      return refuse(fmt::format("{} bytes at byte {} are no page of it", bytes, offset));
    // Without this check, overlapping pages could be read very often.
    if (!seen_.insert(offset).second || bytes > file_.size() - read_)
      return refuse(fmt::format("it leads to the page at byte {} more than once", offset));
    read_ += bytes;
    std::vector<Entry> entries(kReadEntries);
    for (std::uint64_t at = 0; at < bytes && why_not_.empty();) {
      const std::size_t n = std::min<std::uint64_t>(kReadEntries, (bytes - at) / kCopcEntryBytes);
      file_.read_at(offset + at, std::as_writable_bytes(std::span(entries).first(n)));
      for (std::size_t i = 0; i < n && why_not_.empty(); ++i) take(entries[i]);
      at += n * kCopcEntryBytes;
    }
  }

  void take(const Entry& e) {
    const std::int64_t side = e.level >= 0 && e.level <= kMostDepth ? std::int64_t{1} << e.level : 0;
    if (e.x < 0 || e.y < 0 || e.z < 0 || e.x >= side || e.y >= side || e.z >= side)
      return refuse(fmt::format("there is no node {}-{}-{}-{}", e.level, e.x, e.y, e.z));
    if (e.points == kIsPage) {
      pages_.emplace_back(e.offset, static_cast<std::uint64_t>(std::max(e.bytes, 0)));
      return;
    }
    if (e.points == 0) return;
    const std::optional<std::size_t> chunk = chunk_of(e);
    if (!chunk) return refuse(fmt::format("node {}-{}-{}-{} is no chunk of the file", e.level, e.x, e.y, e.z));
    if (!nodes_.boxes[*chunk].empty()) return refuse(fmt::format("chunk {} belongs to two nodes", *chunk + 1));
    nodes_.boxes[*chunk] = box_of(e);
    nodes_.depths[*chunk] = e.level;
  }

  /// Returns the chunk that has the offset, bytes and points of the node; none if there is none.
  std::optional<std::size_t> chunk_of(const Entry& e) const {
    std::size_t low = 0, high = points_.chunks();
    while (low < high) {
      const std::size_t middle = low + (high - low) / 2;
      (points_.first_byte(middle) < e.offset ? low = middle + 1 : high = middle);
    }
    // A chunk without points begins where the next one does.
    for (; low < points_.chunks() && points_.first_byte(low) == e.offset; ++low) {
      const bool fits = e.bytes > 0 && e.points > 0 &&
                        points_.first_byte(low + 1) - e.offset == static_cast<std::uint64_t>(e.bytes) &&
                        points_.first_row(low + 1) - points_.first_row(low) == static_cast<std::uint64_t>(e.points);
      if (fits) return low;
    }
    return {};
  }

  Box box_of(const Entry& e) const {
    const double side = 2 * info_.half_size / static_cast<double>(std::int64_t{1} << e.level);
    const Vec3 corner = info_.center - Vec3{info_.half_size, info_.half_size, info_.half_size};
    const Vec3 lo = corner + side * Vec3{static_cast<double>(e.x), static_cast<double>(e.y), static_cast<double>(e.z)};
    return {lo, lo + Vec3{side, side, side}};
  }

  void refuse(std::string why) { why_not_ = std::move(why); }

  const InputFile& file_;
  const CopcInfo& info_;
  const LazPoints& points_;
  CopcChunks nodes_;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> pages_;  ///< pages to be read: offset, bytes
  std::set<std::uint64_t> seen_;                                ///< offsets of all pages found
  std::uint64_t read_ = 0;                                      ///< bytes of pages read
  std::string why_not_;
};

}  // namespace

std::vector<std::byte> copc_info_bytes(const CopcInfo& info) {
  std::vector<std::byte> bytes(kCopcInfoBytes);
  std::memcpy(bytes.data(), &info, sizeof info);
  return bytes;
}

std::vector<std::byte> copc_hierarchy_bytes(std::vector<CopcNode> nodes) {
  add_ancestors(nodes);
  std::ranges::sort(nodes, {}, [](const CopcNode& node) { return order_of(node.octant); });
  std::vector<std::byte> bytes(nodes.size() * kCopcEntryBytes);
  std::byte* place = bytes.data();
  for (const auto& [octant, offset, size, points] : nodes) {
    const auto at = [&](std::size_t axis) { return static_cast<std::int32_t>(octant.at[axis]); };
    const Entry entry{
        octant.depth, at(0), at(1), at(2), offset, static_cast<std::int32_t>(size), static_cast<std::int32_t>(points)};
    std::memcpy(place, &entry, sizeof entry);
    place += sizeof entry;
  }
  return bytes;
}

CopcChunks read_copc_nodes(const InputFile& file, std::uint64_t info, const LazPoints& points, std::string& why_not) {
  if (points.chunks() == 0) return {};
  CopcInfo about;
  file.read_at(info, std::as_writable_bytes(std::span(&about, 1)));
  Hierarchy hierarchy(file, about, points);
  why_not = hierarchy.read();
  if (!why_not.empty()) return {};
  return std::move(hierarchy).nodes();
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
