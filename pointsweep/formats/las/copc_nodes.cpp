// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/copc_nodes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/formats/las/las_point_formats.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

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
  std::vector<std::pair<std::uint64_t, std::size_t>> order(rows);  // the index keeps equal times in the order of the
                                                                   // curve
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
  std::ranges::sort(nodes_, {},
                    [](const CopcNode& node) { return std::pair(node.octant.depth, first_key(node.octant)); });
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
