// SPDX-License-Identifier: MIT
#include "pointsweep/part/open_forest.h"

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

}  // namespace pointsweep
