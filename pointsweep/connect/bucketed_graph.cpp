// SPDX-License-Identifier: MIT
#include "pointsweep/connect/bucketed_graph.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/connect/row_table.h"
#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

/// Least number of edges that the forest takes at once, but for the last edges of a bucket. The number
/// is large because each SpanningForest::join() goes through all candidate edges.
constexpr std::size_t kEdgesAtOnce = 1 << 16;

template <class T>
void append_bytes(std::vector<std::byte>& bytes, const std::vector<T>& values) {
  const auto added = std::as_bytes(std::span(values));
  bytes.insert(bytes.end(), added.begin(), added.end());
}

template <class T>
const std::byte* take_bytes(const std::byte* from, std::size_t n, std::vector<T>& to) {
  to.resize(n);
  if (n != 0) std::memcpy(to.data(), from, n * sizeof(T));
  return from + n * sizeof(T);
}

/// The rows of the two ends of an edge: the stored form of an edge without weight.
using EndRows = std::array<std::uint64_t, 2>;

}  // namespace

/// Reads the buckets in order. Opens the points of each bucket, joins its edges, and closes the points without later
/// edges. Points for which `stays_open` returns true stay open.
std::uint64_t grow(SpanningForest& forest, const BucketedGraph& graph, const GrowthOptions& options) {
  BucketedGraph::Points chunk;
  std::vector<ForestEdge> edges, some;
  const auto join = [&] {
    forest.join(edges);
    edges.clear();
  };
  std::uint64_t points = 0;
  std::map<std::uint64_t, std::vector<std::uint64_t>> closing;  // for each bucket, rows of points that close after it
  for (std::size_t b = 0; b < graph.buckets(); ++b) {
    RowTable<std::uint64_t> last;
    std::vector<std::uint64_t> rows;
    for (std::size_t c = 0; c < graph.chunks(b); ++c) {
      stop_if_cancelled();
      graph.read_points(b, c, chunk);
      forest.open(chunk.points, chunk.ballots, rows);
      for (const OpenUntil& mark : chunk.marks) {
        std::uint64_t& until = *last.add(mark.row).first;
        until = std::max(until, mark.last);
      }
    }
    for (std::size_t c = 0; c < graph.chunks(b); ++c) {
      stop_if_cancelled();
      graph.read_edges(b, c, some);
      edges.insert(edges.end(), some.begin(), some.end());
      if (edges.size() >= kEdgesAtOnce) join();
    }
    join();
    points += rows.size();
    if (options.progress) options.progress(points);
    if (options.stays_open) std::erase_if(rows, options.stays_open);
    std::erase_if(rows, [&](std::uint64_t row) {
      const std::uint64_t* until = last.find(row);
      if (until != nullptr) closing[*until].push_back(row);
      return until != nullptr;
    });
    if (const auto now = closing.extract(b)) rows.insert(rows.end(), now.mapped().begin(), now.mapped().end());
    forest.close(rows);
  }
  return points;
}

EdgeBuckets::EdgeBuckets(std::vector<PointKey> begins, int axis, bool weighted, std::size_t ballot_bytes,
                         const MakeScratch& make_scratch)
    : axis_(axis),
      weighted_(weighted),
      ballot_bytes_(ballot_bytes),
      begins_(std::move(begins)),
      scratch_(make_scratch()),
      places_(begins_.size() + 1) {
  std::ranges::sort(begins_, AlongAxis{axis_});
}

std::size_t EdgeBuckets::bucket_of(const PointKey& point) const {
  const auto next = std::ranges::upper_bound(begins_, point, AlongAxis{axis_});
  return static_cast<std::size_t>(next - begins_.begin());
}

void EdgeBuckets::put(const EdgeBatch& batch, std::size_t own, std::span<const std::byte> ballots) {
  std::vector<std::size_t> bucket;
  for (const PointKey& point : batch.points()) bucket.push_back(bucket_of(point));
  std::vector<std::pair<std::size_t, Chunk>> chunks;  // few enough for a linear search
  const auto chunk = [&](std::size_t b) -> Chunk& {
    for (auto& [number, known] : chunks)
      if (number == b) return known;
    return chunks.emplace_back(b, Chunk()).second;
  };
  for (std::size_t i = 0; i < own; ++i) {
    Chunk& in = chunk(bucket[i]);
    in.points.push_back(batch.points()[i]);
    const auto ballot = ballots.subspan(i * ballot_bytes_, ballot_bytes_);
    in.ballots.insert(in.ballots.end(), ballot.begin(), ballot.end());
  }
  for (const EdgeBatch::Edge& edge : batch.edges()) {
    const auto [first, last] = std::minmax(bucket[edge.a], bucket[edge.b]);
    chunk(last).edges.push_back(batch.forest_edge(edge));
    if (first != last)
      chunk(first).marks.push_back({batch.points()[bucket[edge.a] == first ? edge.a : edge.b].row, last});
  }
  for (const auto& [b, in] : chunks) put(b, in);
}

void EdgeBuckets::put(std::size_t bucket, const Chunk& chunk) {
  std::vector<std::byte> bytes;
  append_bytes(bytes, chunk.points);
  append_bytes(bytes, chunk.ballots);
  append_bytes(bytes, chunk.marks);
  if (weighted_) {
    append_bytes(bytes, chunk.edges);
  } else {
    std::vector<EndRows> rows;
    for (const ForestEdge& edge : chunk.edges) rows.push_back({edge.a.row, edge.b.row});
    append_bytes(bytes, rows);
  }
  const auto count = [](const auto& all) { return static_cast<std::uint32_t>(all.size()); };
  const std::lock_guard lock(mutex_);
  scratch_->append(bytes);
  places_[bucket].push_back({bytes_, count(chunk.points), count(chunk.marks), count(chunk.edges)});
  bytes_ += bytes.size();
}

void EdgeBuckets::read_points(std::size_t bucket, std::size_t chunk, Points& out) const {
  const Place& place = places_[bucket][chunk];
  std::vector<std::byte> bytes(bytes_before_edges(place));
  if (!bytes.empty()) scratch_->read(place.offset, bytes);
  const std::byte* at = take_bytes(bytes.data(), place.points, out.points);
  at = take_bytes(at, place.points * ballot_bytes_, out.ballots);
  take_bytes(at, place.marks, out.marks);
}

void EdgeBuckets::read_edges(std::size_t bucket, std::size_t chunk, std::vector<ForestEdge>& out) const {
  const Place& place = places_[bucket][chunk];
  std::vector<std::byte> bytes(place.edges * edge_bytes());
  if (!bytes.empty()) scratch_->read(place.offset + bytes_before_edges(place), bytes);
  if (weighted_) return void(take_bytes(bytes.data(), place.edges, out));
  std::vector<EndRows> rows;
  take_bytes(bytes.data(), place.edges, rows);
  out.clear();
  for (const auto& [a, b] : rows) out.push_back({0, {{}, a}, {{}, b}, false});
}

}  // namespace pointsweep
