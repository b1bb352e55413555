// SPDX-License-Identifier: MIT
/// The statistics of a run, for people, programs and plots.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/export.h"

namespace pointsweep {

/// Counts of exact and inexact neighbourhoods of the paper's own algorithm; each point counts once in each sweep.
struct ReferenceCounts {
  std::uint64_t complete = 0;    ///< number of exact neighbourhoods
  std::uint64_t incomplete = 0;  ///< number of neighbourhoods that lack a point, which had left the search too early
  double write_seconds = 0;      ///< seconds in the write operator
  double audit_seconds = 0;      ///< seconds for counting, which is no part of the algorithm
};

/// A bin [from, to) of neighbour distances, in the length unit of the cloud. `nearest` and `farthest` count the points
/// whose nearest and farthest neighbour lies in the bin.
struct DistanceBin {
  double from, to;
  std::uint64_t nearest, farthest;
};

/// The points for which a stage has no result, but the value documented for degenerate data: for example, no normal if
/// all neighbours lie on a line (docs/attributes.md).
struct DegenerateResults {
  std::string stage;  ///< name of the operator
  std::uint64_t count = 0;
  std::vector<std::uint64_t> rows;  ///< rows of such points in the input, from 0, ascending, at most the first 1,000
  bool operator==(const DegenerateResults&) const = default;
};

/// The statistics of a run. A run of several sweeps has sums over the sweeps unless a member says otherwise. In a
/// resumed run, counts of points cover the whole run; times, bytes, series and distances cover only the last process.
struct Statistics {
  std::uint64_t points = 0;          ///< number of points of the input, without dropped nonfinite points
  std::uint64_t points_written = 0;  ///< number of points of the input that no stage has dropped
  std::uint64_t files_written = 0;   ///< number of point files written
  std::uint64_t sweeps = 0;          ///< number of passes that find neighbourhoods
  std::uint64_t k = 0;               ///< number of neighbours in the first sweep; 0 for no limit
  /// Number of points whose neighbourhoods are proven exact, in the sweep with the fewest such points: at the end of a
  /// run, all finite points of that sweep.
  std::uint64_t certified = 0;
  std::uint64_t recalled = 0;    ///< number of neighbourhoods proven by reading a part of the stream again
  std::uint64_t degenerate = 0;  ///< number of results of all stages with the value documented for undefined results
  std::uint64_t nonfinite = 0;   ///< number of points with NaN or infinite coordinates in the input or before a sweep
  std::uint64_t dropped = 0;     ///< number of dropped nonfinite points, which `points` does not count
  std::vector<std::uint64_t> nonfinite_rows;  ///< rows of the first 1,000 nonfinite points of the input, ascending
  std::vector<DegenerateResults> degenerate_results;  ///< degenerate results of each stage of the chain, in its order
  double total_seconds = 0;                           ///< wall time of the run
  double order_seconds = 0;                           ///< wall time of survey and distribution
  double recall_seconds = 0;                          ///< wall time after each sweep for deferred points
  double read_seconds = 0;                            ///< time for loading and cutting slabs, summed over threads
  double search_seconds = 0;                          ///< time for searching neighbours, summed over threads
  double write_seconds = 0;  ///< wall time for writing the results to the output, or passing them to the next sweep
  std::vector<std::pair<std::string, double>> operator_seconds;  ///< time in each operator, summed over threads
  /// Bytes read, spilled to temporary files and written. Bytes read count the records of the input in each pass, and
  /// the spilled points that recalls have read again.
  std::uint64_t bytes_read = 0, bytes_spilled = 0, bytes_written = 0;
  /// Parts of bytes_spilled: bytes of points that are put in order, and bytes of inputs that are decoded once.
  std::uint64_t bytes_spilled_ordering = 0, bytes_spilled_decoding = 0;
  /// A clause without a full stop: how the points of the first sweep were put in order, and why.
  std::string ordering;
  std::uint64_t peak_rss_bytes = 0, memory_budget_bytes = 0;
  std::uint64_t peak_points = 0;  ///< largest number of points in the window in any sweep
  double mean_points = 0;
  /// Pairs of the number of points read, which continues from sweep to sweep, and the number of points in the window.
  std::vector<std::pair<std::uint64_t, std::uint64_t>> series;
  /// For each operator or step of the engine, its name and pairs of the number of points read and of points in its
  /// buffer.
  std::vector<std::pair<std::string, std::vector<std::pair<std::uint64_t, std::uint64_t>>>> buffers;
  double lifespan_mean_seconds = 0, lifespan_max_seconds = 0;  ///< seconds that a point stays in the window
  std::optional<ReferenceCounts> reference;  ///< counts of a run by the paper's algorithm; absent for other runs
  /// Neighbour distances of the first sweep, eight bins for each octave; empty unless RunOptions::count_distances.
  std::vector<DistanceBin> neighbor_distances;
  unsigned threads = 1;
  std::string machine;
  std::vector<std::string> warnings;  ///< sentences of Observer::on_warning() and, except estimates, on_note()
};

/// Returns one JSON object; series are thinned to at most 1,000 rows.
POINTSWEEP_EXPORT std::string to_json(const Statistics& statistics);

}  // namespace pointsweep
