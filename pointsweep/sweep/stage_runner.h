// SPDX-License-Identifier: MIT
/// Applies the stages of a step to a batch of points whose neighbourhoods are known.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/connect/edge_batch.h"
#include "pointsweep/operators/kinds/connect_operator.h"
#include "pointsweep/points/degenerate_points.h"
#include "pointsweep/row_error.h"
#include "pointsweep/sweep/plan.h"

namespace pointsweep {

struct Batch;

/// Passes the edges between neighbours that a connecting stage emits for a batch to a sink. Not thread-safe: each
/// thread has its own emitter, whose memory is reused from batch to batch.
class EdgeEmitter {
 public:
  explicit EdgeEmitter(EdgeSink& sink) : sink_(sink) {}
  void take(const ConnectOperator& op, const Neighborhoods& in, const Batch& batch);

  /// Returns the bytes that the edges to one neighbour take while a batch is processed.
  static constexpr std::uint64_t bytes_per_neighbor(bool weighted) {
    constexpr std::uint64_t kGrowth = 2;  // capacity of a growing vector, as a multiple of its size
    return kGrowth * sizeof(NeighborEdge) + EdgeBatch::bytes_per_edge(weighted);
  }

 private:
  EdgeSink& sink_;
  EdgeBatch graph_;
  std::vector<NeighborEdge> edges_;
  std::vector<std::byte> ballots_;
};

/// Number of points that a bucket of a graph should hold (see BucketedGraph).
inline constexpr std::uint64_t kBucketPoints = 16384;

/// Returns the places where buckets of a graph begin: at each slab of the sweep, at `places`, and within large slabs,
/// so that a bucket contains at most about kBucketPoints points if these are spread evenly along the axis. The result
/// is not sorted.
std::vector<PointKey> bucket_begins(const class Stream& stream, std::span<const Vec3> places);

/// Counts of distances, in eight bins for each factor of 2. The number of a bin is the exponent and the two leading
/// bits of the mantissa of the squared distance as an IEEE double. Counts do not depend on the order of distances.
/// Memory: 64 KB.
class DistanceHistogram {
 public:
  static constexpr std::size_t kBins = 8192;

  void add(double distance2) { ++counts_[std::bit_cast<std::uint64_t>(distance2) >> 50 & (kBins - 1)]; }
  void add(const DistanceHistogram& other) {
    for (std::size_t i = 0; i < kBins; ++i) counts_[i] += other.counts_[i];
  }
  std::uint64_t count(std::size_t bin) const { return counts_[bin]; }
  /// Returns the smallest squared distance of a bin. Bin 0 holds 0 and the smallest squared distances.
  static double lower_end2(std::size_t bin) { return std::bit_cast<double>(std::uint64_t{bin} << 50); }

 private:
  std::array<std::uint64_t, kBins> counts_{};
};

/// Histograms of the distances from each point to the nearest and to the farthest point of its neighbourhood.
struct NeighborDistances {
  DistanceHistogram nearest, farthest;
  void add(const NeighborDistances& other) {
    nearest.add(other.nearest);
    farthest.add(other.farthest);
  }
};

/// Times, degenerate points and errors of the stages that one thread has run.
struct StageTally {
  std::vector<double> seconds;           ///< seconds of each stage
  std::vector<DegeneratePoints> marked;  ///< for each stage of the last step, degenerate points of the last batch
  /// For each stage, the rows of marked points whose results are final. Callers of run_step() add these rows.
  std::vector<DegenerateRows> degenerate;
  FirstRowError refused;                         ///< error of a stage that refused a row, which ends the pass
  std::unique_ptr<NeighborDistances> distances;  ///< filled if not null
  std::unique_ptr<EdgeEmitter> edges;            ///< takes the edges of a connecting stage if not null
};

/// A batch of points with their neighbour lists, to which stages are applied. A stage reads columns through `own`, and
/// fills columns through `made`.
struct Batch {
  PointColumns own;  ///< points of the batch and their columns
  std::size_t size = 0;
  const PointColumns* slots = nullptr;   ///< points of the cell in each slot
  const std::uint32_t* begin = nullptr;  ///< size + 1 entries; the list of point i is refs[begin[i] .. begin[i+1])
  const NeighborRef* refs = nullptr;
  std::byte* const* made = nullptr;  ///< writable columns by column number
};

/// Calls `use(stage, point of the batch)` for each point that a stage of `step` has marked as degenerate. `step` must
/// be the step that was run last.
template <class Use>
void for_each_marked(const SweepPlan& plan, std::size_t step, const StageTally& tally, Use use) {
  for (std::size_t s = plan.steps[step]; s < plan.steps[step + 1]; ++s)
    tally.marked[s].for_each([&](std::size_t i) { use(s, i); });
}

/// Applies stage `s` of the plan to the batch.
void run_stage(const SweepPlan& plan, std::size_t s, const Batch& batch, StageTally& tally);

/// Applies all stages of the step to the batch. Step 0 also counts distances if tally.distances is not null.
void run_step(const SweepPlan& plan, std::size_t step, const Batch& batch, StageTally& tally);

/// Fills `results` with the result records of `size` points, copied from their result columns.
void collect_results(const SweepPlan& plan, const std::byte* const* columns, std::size_t size,
                     std::vector<std::byte>& results);

}  // namespace pointsweep
