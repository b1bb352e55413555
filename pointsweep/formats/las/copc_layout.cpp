// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/copc_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <set>
#include <span>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/formats/las/las_point_formats.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::size_t kReadEntries = 1024;
constexpr std::int32_t kIsPage = -1;  ///< value of Entry::points for an entry that refers to another page

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

/// An entry of the hierarchy in the layout of the file.
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

  /// Returns the chunk that has the offset, bytes and points of the node; nothing if no chunk has them.
  std::optional<std::size_t> chunk_of(const Entry& e) const {
    std::size_t low = 0, high = points_.chunks();
    while (low < high) {
      const std::size_t middle = low + (high - low) / 2;
      (points_.first_byte(middle) < e.offset ? low = middle + 1 : high = middle);
    }
    // A chunk without points begins at the same byte as the chunk after it.
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
  std::set<std::uint64_t> seen_;                                ///< offsets of all pages read
  std::uint64_t read_ = 0;                                      ///< bytes of pages read
  std::string why_not_;
};

/// Largest number of points or bytes of a node: the hierarchy stores both as signed 32-bit integers.
constexpr std::uint64_t kMostOfChunk = std::numeric_limits<std::int32_t>::max();

/// Returns an unsigned number that ascends with the GPS time; NaN comes first or last.
std::uint64_t order_of_time(const std::byte* record) {
  std::uint64_t bits;
  std::memcpy(&bits, record + kLasModernTimeAt, sizeof bits);
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
  return (bits & kSign) != 0 ? ~bits : bits | kSign;
}

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

CopcNodes::CopcNodes(const LazLayout& laz, std::size_t record_bytes, std::uint64_t memory_bytes,
                     std::uint64_t most_node_bytes, std::unique_ptr<Scratch> aside, std::string path)
    : laz_(laz),
      record_bytes_(record_bytes),
      memory_(memory_bytes),
      most_node_bytes_(most_node_bytes),
      aside_(std::move(aside)),
      path_(std::move(path)) {}

void CopcNodes::add(const CurveKey& key, int depth, const std::byte* record) {
  if (key != last_) {
    for (int d = common_depth(last_, key) + 1; d <= kMostDepth; ++d) close(d);
    last_ = key;
  }
  std::vector<std::byte>& records = open_[static_cast<std::size_t>(depth)];
  if (records.size() >= most_node_bytes_)
    fail(
        "{}: more than {} points lie so close together that they are one node, for which the memory budget has no "
        "room; "
        "allow more memory (--memory), or write LAZ.",
        path_, records.size() / record_bytes_);
  records.insert(records.end(), record, record + record_bytes_);
  double time;
  std::memcpy(&time, record + kLasModernTimeAt, sizeof time);
  if (std::isnan(time)) return;
  times_ = std::exchange(has_times_, true) ? TimeRange{std::min(times_.least, time), std::max(times_.greatest, time)}
                                           : TimeRange{time, time};
}

void CopcNodes::close(int depth) {
  std::vector<std::byte>& records = open_[static_cast<std::size_t>(depth)];
  if (records.empty()) return;
  if (records.size() / record_bytes_ > kMostOfChunk)
    fail("{}: {} points lie so close together that they are one node, and COPC allows {}; write LAZ.", path_,
         records.size() / record_bytes_, kMostOfChunk);
  waiting_bytes_ += records.size();
  waiting_.push_back({octant_of(last_, depth), std::exchange(records, {})});
  if (waiting_bytes_ > memory_) compress();
}

void CopcNodes::compress() {
  std::vector<std::vector<std::byte>> chunks(waiting_.size());
  parallel_for(waiting_.size(), [&](std::size_t i, unsigned) {
    stop_if_cancelled();
    sort_by_time(waiting_[i].records);
    chunks[i] = laz_.compress(waiting_[i].records);
  });
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    if (chunks[i].size() > kMostOfChunk)
      fail("{}: {} points lie so close together that they are one node of {} bytes, and COPC allows {}; write LAZ.",
           path_, waiting_[i].records.size() / record_bytes_, chunks[i].size(), kMostOfChunk);
    nodes_.push_back({.octant = waiting_[i].octant,
                      .offset = aside_bytes_,
                      .bytes = static_cast<std::uint32_t>(chunks[i].size()),
                      .points = static_cast<std::uint32_t>(waiting_[i].records.size() / record_bytes_)});
    aside_->append(chunks[i]);
    aside_bytes_ += chunks[i].size();
  }
  waiting_.clear();
  waiting_bytes_ = 0;
}

void CopcNodes::sort_by_time(std::vector<std::byte>& records) const {
  const std::size_t rows = records.size() / record_bytes_;
  // Pairs of time and index; the index keeps points of equal time in the order of the Morton curve.
  std::vector<std::pair<std::uint64_t, std::size_t>> order(rows);
  for (std::size_t i = 0; i < rows; ++i) order[i] = {order_of_time(&records[i * record_bytes_]), i};
  if (std::ranges::is_sorted(order)) return;
  std::ranges::sort(order);
  std::vector<std::byte> sorted(records.size());
  for (std::size_t i = 0; i < rows; ++i)
    std::memcpy(&sorted[i * record_bytes_], &records[order[i].second * record_bytes_], record_bytes_);
  records = std::move(sorted);
}

std::vector<CopcNode> CopcNodes::finish(std::uint64_t at, const Put& put) {
  for (int depth = 0; depth <= kMostDepth; ++depth) close(depth);
  compress();
  std::ranges::sort(nodes_, {}, [](const CopcNode& node) { return order_of(node.octant); });
  std::vector<std::byte> chunk;
  for (CopcNode& node : nodes_) {
    stop_if_cancelled();
    chunk.resize(node.bytes);
    aside_->read(node.offset, chunk);
    node.offset = at;
    put(at, chunk);
    at += chunk.size();
  }
  return std::move(nodes_);
}

}  // namespace pointsweep
