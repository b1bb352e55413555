// SPDX-License-Identifier: MIT
#include "pointsweep/connect/edge_buckets.h"

#include <algorithm>
#include <cstring>
#include <tuple>
#include <utility>

namespace pointsweep {
namespace {

/// The points, edges and marks of a batch that go into one bucket. Points and edges are numbers in the batch.
struct BucketContent {
  std::vector<std::uint32_t> points, edges;
  std::vector<OpenUntil> marks;
};

template <class T>
void append_bytes(std::vector<std::byte>& bytes, const T& value) {
  const auto* from = reinterpret_cast<const std::byte*>(&value);
  bytes.insert(bytes.end(), from, from + sizeof value);
}

template <class T>
const std::byte* take_bytes(const std::byte* from, std::size_t n, std::vector<T>& to) {
  to.resize(n);
  if (n != 0) std::memcpy(to.data(), from, n * sizeof(T));
  return from + n * sizeof(T);
}

}  // namespace

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
  std::vector<std::pair<std::size_t, BucketContent>> contents;  // few
  const auto content = [&](std::size_t b) -> BucketContent& {
    for (auto& [number, known] : contents)
      if (number == b) return known;
    return contents.emplace_back(b, BucketContent()).second;
  };
  for (std::uint32_t i = 0; i < own; ++i) content(bucket[i]).points.push_back(i);
  for (std::uint32_t e = 0; e < batch.edges().size(); ++e) {
    const auto [a, b, weight, flips] = batch.edges()[e];
    const auto [first, last] = std::minmax(bucket[a], bucket[b]);
    content(last).edges.push_back(e);
    if (first != last) content(first).marks.push_back({batch.points()[bucket[a] == first ? a : b].row, last});
  }
  std::vector<std::byte> bytes;
  for (const auto& [b, in] : contents) {
    bytes.clear();
    for (const std::uint32_t i : in.points) append_bytes(bytes, batch.points()[i]);
    for (const std::uint32_t i : in.points) {
      const auto ballot = ballots.subspan(i * ballot_bytes_, ballot_bytes_);
      bytes.insert(bytes.end(), ballot.begin(), ballot.end());
    }
    for (const std::uint32_t e : in.edges) {
      const ForestEdge edge = batch.forest_edge(batch.edges()[e]);
      weighted_ ? append_bytes(bytes, edge) : append_bytes(bytes, std::array{edge.a.row, edge.b.row});
    }
    for (const OpenUntil& mark : in.marks) append_bytes(bytes, mark);
    const auto count = [](const auto& all) { return static_cast<std::uint32_t>(all.size()); };
    const std::lock_guard lock(mutex_);
    scratch_->append(bytes);
    places_[b].push_back({bytes_, count(in.points), count(in.edges), count(in.marks)});
    bytes_ += bytes.size();
  }
}

void EdgeBuckets::read(std::size_t bucket, std::size_t chunk, Chunk& out) const {
  const Place& place = places_[bucket][chunk];
  std::vector<std::byte> bytes(place.points * (sizeof(PointKey) + ballot_bytes_) + place.edges * edge_bytes() +
                               place.marks * sizeof(OpenUntil));
  if (!bytes.empty()) scratch_->read(place.offset, bytes);
  const std::byte* at = take_bytes(bytes.data(), place.points, out.points);
  at = take_bytes(at, place.points * ballot_bytes_, out.ballots);
  if (weighted_) {
    at = take_bytes(at, place.edges, out.edges);
  } else {
    std::vector<std::array<std::uint64_t, 2>> rows;
    at = take_bytes(at, place.edges, rows);
    out.edges.clear();
    for (const auto& [a, b] : rows) out.edges.push_back({0, {{}, a}, {{}, b}, false});
  }
  take_bytes(at, place.marks, out.marks);
}

}  // namespace pointsweep
