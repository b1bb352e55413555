// SPDX-License-Identifier: MIT
/// The method of the paper, point by point: a baseline for the speed of the engine, and an independent check of its
/// results.
///
/// R. Pajarola, "Stream-Processing Points", IEEE Visualization 2005. The reference shares with the engine attributes,
/// file formats, the ordered stream (Section 3 takes it for given) and the formulas of the operators; search, buffers
/// and the sweep are its own. One thread. Memory holds the active set, whose size depends on the cloud: in FIFO order
/// every point waits for the slowest point before it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/neighborhood.h"
#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/points/degenerate_points.h"
#include "reference/stream_point.h"

namespace pointsweep::reference {

struct Task {
  Reach reach;
  SharedRule rule;                       ///< shortens each list of neighbours once it is complete; may be null
  std::vector<StageOperator> operators;  ///< must have been checked against the stream's records
  std::vector<Attribute> kept;           ///< attributes to write; a result record has them in this order
};

/// A finished point. Points are finished in stream order.
struct Written {
  std::uint64_t index;       ///< place in the stream
  std::uint64_t row;         ///< row in the input
  const std::byte* record;   ///< working record of the stream
  const std::byte* results;  ///< kept attributes, one after another
};

struct Options {
  std::uint64_t memory_bytes = 0;  ///< limit for the active set; run() throws Error above it
  /// Called about every tenth of a second with the points read and active so far; may throw to end the run.
  std::function<void(std::uint64_t points_read, std::uint64_t points_active)> progress;
};

/// Measurements of one stream operator.
struct OperatorRecord {
  std::string name;  ///< "read", "knn", the names of the operators of the task, "write"
  double seconds = 0;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> series;  ///< points read, points in the buffer; at most 1,000
                                                                ///< entries
};

struct Statistics {
  std::vector<OperatorRecord> operators;   ///< as in Figures 4 and 6, in the order of the pipeline
  double audit_seconds = 0;                ///< not included in any other time
  std::uint64_t complete = 0;              ///< neighbourhoods N_i that are exact
  std::uint64_t incomplete = 0;            ///< neighbourhoods that are not exact: a point had left the search too early
  std::vector<DegenerateRows> degenerate;  ///< rows with degenerate results, for each operator of the task
  std::uint64_t peak_points = 0;
  double mean_points = 0;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> series;  ///< points read, points active; at most 1,000 entries
  double lifespan_mean = 0, lifespan_max = 0;                   ///< seconds from being read to being written
};

/// Runs the task over the stream, whose slabs must be in canonical order (StreamOptions::canonical), and gives every
/// point of it to `write`. O(k n log m) for m active points.
Statistics run(const Stream& stream, const Task& task, const std::function<void(const Written&)>& write,
               const Options& options);

}  // namespace pointsweep::reference
