// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/stage_runner.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/points/record_map.h"

namespace pointsweep {
namespace {

PointKey key_in(const PointColumns& points, std::size_t i) {
  return {{points.x[i], points.y[i], points.z[i]}, points.row[i]};
}

void count_distances(const Batch& batch, NeighborDistances& distances) {
  const Neighborhoods in(batch.own, batch.size, batch.slots, batch.begin, batch.refs, {}, {});
  for (std::size_t i = 0; i < in.size(); ++i) {
    if (in.count(i) == 0) continue;
    distances.nearest.add(in.distance2(i, 0));
    distances.farthest.add(in.farthest_distance2(i));
  }
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
  graph_.reduce(sink_.weighted());
  sink_.put(graph_, batch.size, ballots_);
}

std::vector<PointKey> bucket_begins(const Stream& stream, std::span<const Vec3> places) {
  const int axis = stream.axis();
  std::vector<PointKey> begins;
  for (const Vec3& place : places) begins.push_back({place, 0});
  for (const Slab& slab : std::span(stream.slabs()).first(stream.swept_slabs())) {
    const bool is_one_place = slab.box.lo == slab.box.hi;  // buckets divide copies of one point by their rows
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

void run_stage(const SweepPlan& plan, std::size_t s, const Batch& batch, StageTally& tally) {
  stop_if_cancelled();
  tally.seconds.resize(plan.stages.size());
  tally.marked.resize(plan.stages.size());
  tally.degenerate.resize(plan.stages.size());
  const auto start = std::chrono::steady_clock::now();
  const Stage& stage = plan.stages[s];
  std::vector<std::byte*> made;
  std::vector<bool> unwanted;
  std::vector<std::size_t> bytes;
  for (const std::uint16_t column : stage.makes) {
    made.push_back(batch.made[column]);
    unwanted.push_back(plan.lifetimes[column] == Lifetime::none);
    bytes.push_back(plan.column_bytes[column]);
  }
  const Neighborhoods in(batch.own, batch.size, batch.slots, batch.begin, batch.refs, stage.reads,
                         stage.reads_neighbors, stage.position, false, plan.column_bytes.data());
  tally.marked[s] = {};
  Columns out(made, batch.size, tally.marked[s], std::move(unwanted), std::move(bytes));
  const ConnectOperator* connects = stage.connects();
  if (connects == nullptr)
    tally.refused.note_from([&] { apply(stage.op, in, out); });
  else if (tally.edges)
    tally.edges->take(*connects, in, batch);
  tally.seconds[s] += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void run_step(const SweepPlan& plan, std::size_t step, const Batch& batch, StageTally& tally) {
  if (step == 0 && tally.distances) count_distances(batch, *tally.distances);
  for (std::size_t s = plan.steps[step]; s < plan.steps[step + 1]; ++s) run_stage(plan, s, batch, tally);
}

void collect_results(const SweepPlan& plan, const std::byte* const* columns, std::size_t size,
                     std::vector<std::byte>& results) {
  results.resize(size * plan.result_bytes);
  constexpr std::size_t kBlock = 64;  // records that stay in the first-level cache while their columns are copied
  for (std::size_t first = 0; first < size; first += kBlock) {
    const std::size_t end = std::min(first + kBlock, size);
    for (const ResultColumn& r : plan.results) {
      const std::byte* from = columns[r.column];
      std::byte* to = results.data() + r.offset;
      with_fixed_size(r.bytes, [&](auto bytes) {
        for (std::size_t i = first; i < end; ++i)
          copy_bytes<bytes()>(to + i * plan.result_bytes, from + i * r.bytes, r.bytes);
      });
    }
  }
}

}  // namespace pointsweep
