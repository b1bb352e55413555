// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/edge_emitter.h"

#include <cmath>

#include "pointsweep/order/stream.h"
#include "pointsweep/sweep/stage_runner.h"

namespace pointsweep {
namespace {

PointKey key_in(const PointColumns& points, std::size_t i) {
  return {{points.x[i], points.y[i], points.z[i]}, points.row[i]};
}

}  // namespace

void EdgeEmitter::take(const ConnectOperator& op, const Neighborhoods& in, const Batch& batch) {
  const VoteRule* votes = op.votes();
  edges_.clear();
  ballots_.assign(votes != nullptr ? batch.size * votes->ballot_bytes() : 0, std::byte{0});
  op.connect(in, edges_, ballots_.data());
  graph_.clear();
  for (std::size_t i = 0; i < batch.size; ++i) graph_.number_of(key_in(batch.own, i));
  graph_.reserve(edges_.size());
  for (const NeighborEdge& e : edges_) {
    const std::uint32_t other = graph_.number_of(key_in(batch.slots[slot_of(e.neighbor)], index_of(e.neighbor)));
    graph_.add(e.point, other, e.weight, e.flips);
  }
  graph_.reduce(buckets_.weighted());
  buckets_.put(graph_, batch.size, ballots_);
}

std::vector<PointKey> bucket_begins(const Stream& stream, std::span<const Vec3> places) {
  const int axis = stream.axis();
  std::vector<PointKey> begins;
  for (const Vec3& place : places) begins.push_back({place, 0});
  for (const Slab& slab : stream.slabs()) {
    const bool is_one_place = slab.box.lo == slab.box.hi;  // copies of a point are divided by their rows
    begins.push_back({slab.box.lo, is_one_place ? slab.least_row : 0});
    const double parts = std::ceil(static_cast<double>(slab.count) / static_cast<double>(kBucketPoints));
    for (double part = 1; part < parts; ++part) {
      Vec3 place = slab.box.lo;
      place[axis] += part / parts * slab.box.extent()[axis];
      if (place[axis] > slab.box.lo[axis]) begins.push_back({place, 0});
    }
  }
  return begins;
}

}  // namespace pointsweep
