// SPDX-License-Identifier: MIT
#include "pointsweep/part/stored_graph.h"

#include <algorithm>
#include <cstring>
#include <span>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kAtOnce = 8192;  ///< most points, most edges and most marks of a chunk

template <class T>
void read_some(const RecordList& list, std::uint64_t first, std::uint64_t count, std::uint64_t chunk,
               std::vector<T>& to) {
  const std::uint64_t begin = std::min(count, chunk * kAtOnce);
  to.resize(std::min(count, begin + kAtOnce) - begin);
  list.read(first + begin, std::as_writable_bytes(std::span(to)));
}

}  // namespace

void store_graph(const BucketedGraph& graph, std::size_t ballot_bytes, Storage& scratch, const std::string& name) {
  RecordListWriter nodes(scratch, name + ".nodes", sizeof(PointKey) + ballot_bytes);
  RecordListWriter edges(scratch, name + ".edges", sizeof(ForestEdge));
  RecordListWriter marks(scratch, name + ".marks", sizeof(OpenUntil));
  RecordListWriter buckets(scratch, name + ".buckets", sizeof(StoredGraph::Counts));
  BucketedGraph::Points chunk;
  std::vector<ForestEdge> some;
  std::vector<std::byte> node(sizeof(PointKey) + ballot_bytes);
  for (std::size_t b = 0; b < graph.buckets(); ++b) {
    StoredGraph::Counts count;
    for (std::size_t c = 0; c < graph.chunks(b); ++c) {
      stop_if_cancelled();
      graph.read_points(b, c, chunk);
      graph.read_edges(b, c, some);
      for (std::size_t i = 0; i < chunk.points.size(); ++i) {
        std::memcpy(node.data(), &chunk.points[i], sizeof(PointKey));
        std::copy_n(chunk.ballots.data() + i * ballot_bytes, ballot_bytes, node.data() + sizeof(PointKey));
        nodes.append(node);
      }
      edges.append(std::as_bytes(std::span(some)));
      marks.append(std::as_bytes(std::span(chunk.marks)));
      count = {count.points + chunk.points.size(), count.edges + some.size(), count.marks + chunk.marks.size()};
    }
    buckets.append(std::as_bytes(std::span(&count, 1)));
  }
  for (RecordListWriter* const list : {&nodes, &edges, &marks, &buckets}) list->seal();
}

StoredGraph::StoredGraph(const Storage& scratch, const std::string& name, std::size_t ballot_bytes)
    : ballot_bytes_(ballot_bytes),
      nodes_(scratch, name + ".nodes", sizeof(PointKey) + ballot_bytes),
      edges_(scratch, name + ".edges", sizeof(ForestEdge)),
      marks_(scratch, name + ".marks", sizeof(OpenUntil)) {
  const RecordList buckets(scratch, name + ".buckets", sizeof(Counts));
  std::vector<Counts> counts(buckets.count());
  buckets.read(0, std::as_writable_bytes(std::span(counts)));
  Counts next;
  for (const Counts& count : counts) {
    buckets_.push_back({next, count});
    next = {next.points + count.points, next.edges + count.edges, next.marks + count.marks};
  }
  if (next.points != nodes_.count()) fail("{}.nodes: is damaged.", name);
  if (next.edges != edges_.count()) fail("{}.edges: is damaged.", name);
  if (next.marks != marks_.count()) fail("{}.marks: is damaged.", name);
}

std::size_t StoredGraph::chunks(std::size_t bucket) const {
  const Counts& count = buckets_[bucket].count;
  return static_cast<std::size_t>((std::max({count.points, count.edges, count.marks}) + kAtOnce - 1) / kAtOnce);
}

void StoredGraph::read_points(std::size_t bucket, std::size_t chunk, Points& out) const {
  const auto& [first, count] = buckets_[bucket];
  const std::size_t node_bytes = sizeof(PointKey) + ballot_bytes_;
  const std::uint64_t begin = std::min(count.points, chunk * kAtOnce);
  std::vector<std::byte> nodes((std::min(count.points, begin + kAtOnce) - begin) * node_bytes);
  nodes_.read(first.points + begin, nodes);
  out.points.resize(nodes.size() / node_bytes);
  out.ballots.resize(out.points.size() * ballot_bytes_);
  for (std::size_t i = 0; i < out.points.size(); ++i) {
    const std::byte* const node = nodes.data() + i * node_bytes;
    std::memcpy(&out.points[i], node, sizeof(PointKey));
    std::copy_n(node + sizeof(PointKey), ballot_bytes_, out.ballots.data() + i * ballot_bytes_);
  }
  read_some(marks_, first.marks, count.marks, chunk, out.marks);
}

void StoredGraph::read_edges(std::size_t bucket, std::size_t chunk, std::vector<ForestEdge>& out) const {
  const auto& [first, count] = buckets_[bucket];
  read_some(edges_, first.edges, count.edges, chunk, out);
}

}  // namespace pointsweep
