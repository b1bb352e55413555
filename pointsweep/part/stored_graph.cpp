// SPDX-License-Identifier: MIT
#include "pointsweep/part/stored_graph.h"

#include <algorithm>
#include <cstring>
#include <span>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

constexpr Encoding kBorderEncoding{"border of a tile", 1};
constexpr Encoding kForestEncoding{"open forest", 1};

void put_key(Encoder& out, const PointKey& point) {
  out.put_point(point.position);
  out.put<std::uint64_t>(point.row);
}

PointKey get_key(Decoder& in) {
  const Vec3 position = in.get_point();
  return {position, in.get<std::uint64_t>()};
}

void put_edge(Encoder& out, const ForestEdge& edge) {
  out.put<double>(edge.weight);
  put_key(out, edge.a);
  put_key(out, edge.b);
  out.put_bool(edge.flips);
}

ForestEdge get_edge(Decoder& in) {
  ForestEdge edge;
  edge.weight = in.get<double>();
  edge.a = get_key(in);
  edge.b = get_key(in);
  edge.flips = in.get_bool();
  return edge;
}

constexpr std::uint64_t kAtOnce = 8192;  ///< most points, most edges and most marks of a chunk

template <class T>
void read_some(const RecordList& list, std::uint64_t first, std::uint64_t count, std::uint64_t chunk,
               std::vector<T>& to) {
  const std::uint64_t begin = std::min(count, chunk * kAtOnce);
  to.resize(std::min(count, begin + kAtOnce) - begin);
  list.read(first + begin, std::as_writable_bytes(std::span(to)));
}

}  // namespace

void TileBorder::encode(Encoder& out) const {
  out.begin(kBorderEncoding);
  out.put_list(points, [&](const Point& point) {
    out.put<std::uint64_t>(point.row);
    out.put<std::uint64_t>(point.last);
  });
  out.put_list(edges, [&](const ForestEdge& edge) { put_edge(out, edge); });
}

TileBorder TileBorder::decode(Decoder& in) {
  in.begin(kBorderEncoding);
  TileBorder border;
  border.points = in.get_list<Point>([&] {
    const auto row = in.get<std::uint64_t>();
    return Point{row, in.get<std::uint64_t>()};
  });
  border.edges = in.get_list<ForestEdge>([&] { return get_edge(in); });
  return border;
}

void encode(Encoder& out, const OpenForest& forest) {
  out.begin(kForestEncoding);
  out.put_list(forest.supernodes, [&](const FinishedComponent& supernode) {
    put_key(out, supernode.first);
    out.put<std::uint64_t>(supernode.points);
  });
  out.put_bytes(forest.votes);
  out.put_list(forest.points, [&](const OpenForest::Point& point) {
    out.put<std::uint64_t>(point.row);
    out.put<std::uint32_t>(point.supernode);
    out.put_bool(point.flips);
  });
  out.put_list(forest.candidates, [&](const OpenForest::Candidate& candidate) {
    put_edge(out, candidate.edge);
    out.put<std::uint32_t>(candidate.a);
    out.put<std::uint32_t>(candidate.b);
    out.put_bool(candidate.flips);
  });
}

OpenForest decode_open_forest(Decoder& in, std::size_t vote_bytes) {
  in.begin(kForestEncoding);
  OpenForest forest;
  forest.supernodes = in.get_list<FinishedComponent>([&] {
    const PointKey first = get_key(in);
    return FinishedComponent{first, in.get<std::uint64_t>()};
  });
  const auto get_supernode = [&] {
    const auto supernode = in.get<std::uint32_t>();
    if (supernode >= forest.supernodes.size())
      fail("An open forest of {} supernodes names supernode {}.", forest.supernodes.size(), supernode);
    return supernode;
  };
  forest.votes = in.get_bytes();
  if (forest.votes.size() != forest.supernodes.size() * vote_bytes)
    fail("An open forest has {} bytes of votes for {} supernodes.", forest.votes.size(), forest.supernodes.size());
  forest.points = in.get_list<OpenForest::Point>([&] {
    const auto row = in.get<std::uint64_t>();
    const std::uint32_t supernode = get_supernode();
    return OpenForest::Point{row, supernode, in.get_bool()};
  });
  forest.candidates = in.get_list<OpenForest::Candidate>([&] {
    const ForestEdge edge = get_edge(in);
    const std::uint32_t a = get_supernode(), b = get_supernode();
    return OpenForest::Candidate{edge, a, b, in.get_bool()};
  });
  return forest;
}

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
