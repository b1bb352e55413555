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
  std::uint64_t complete = 0;    ///< exact
  std::uint64_t incomplete = 0;  ///< results that are not exact, since a point had left the search too early
  double write_seconds = 0;      ///< time in the write operator
  double audit_seconds = 0;      ///< time for finding these counts; not a part of the algorithm
};

/// A bin [from, to) of neighbour distances, in the length unit of the cloud. `nearest` and `farthest` count the points
/// whose nearest and farthest neighbour lies in the bin.
struct DistanceBin {
  double from, to;
  std::uint64_t nearest, farthest;
};

/// Results with the documented value for degenerate data: no normal if all neighbours lie on a line, for example
/// (docs/attributes.md).
struct DegenerateResults {
  std::string stage;  ///< name of the operator
  std::uint64_t count = 0;
  std::vector<std::uint64_t> rows;  ///< rows of the input, from 0, ascending, at most the first 1,000
  bool operator==(const DegenerateResults&) const = default;
};

/// The statistics of a run. A run of several sweeps has sums over the sweeps unless a member says otherwise. In a
/// resumed run, counts of points cover the whole run; times, bytes, series and distances cover only the last process.
struct Statistics {
  std::uint64_t points = 0;          ///< points of the input, without the dropped ones
  std::uint64_t points_written = 0;  ///< points of the input that no select has dropped
  std::uint64_t files_written = 0;   ///< point files
  std::uint64_t sweeps = 0;          ///< passes that find neighbourhoods
  std::uint64_t k = 0;               ///< number of neighbours in the first sweep; 0: no limit
  std::uint64_t certified = 0;       ///< points whose neighbourhoods are proven exact in every sweep: all finite points
                                     ///< that the last sweep has
  std::uint64_t recalled = 0;    ///< neighbourhoods proven by reading a part of the stream again
  std::uint64_t degenerate = 0;  ///< results with the documented value for undefined ones, of all stages
  std::uint64_t nonfinite = 0;   ///< points whose coordinates are NaN or infinite, in the input or when a sweep begins
  std::uint64_t dropped = 0;     ///< nonfinite points that were dropped; `points` does not count them
  std::vector<std::uint64_t> nonfinite_rows;          ///< rows of the input, from 0, ascending, at most the first 1,000
  std::vector<DegenerateResults> degenerate_results;  ///< for every stage of the chain, in its order
  double total_seconds = 0;                           ///< wall
  double order_seconds = 0;                           ///< wall: survey and distribution
  double recall_seconds = 0;                          ///< wall time after each sweep, for deferred points
  double read_seconds = 0;                            ///< loading and cutting slabs, summed over threads
  double search_seconds = 0;                          ///< summed over threads
  double write_seconds = 0;  ///< wall time for writing the results to the output, or passing them to the next sweep
  std::vector<std::pair<std::string, double>> operator_seconds;  ///< summed over threads
  /// bytes_read: records of the input in each pass, and spilled points that recalls have read again.
  std::uint64_t bytes_read = 0, bytes_spilled = 0, bytes_written = 0;
  /// Parts of bytes_spilled: bytes of points that are put in order, and bytes of inputs that are decoded once.
  std::uint64_t bytes_spilled_ordering = 0, bytes_spilled_decoding = 0;
  std::string ordering;  ///< how the points of the first sweep were put in order, and why; a sentence without a full
                         ///< stop
  std::uint64_t peak_rss_bytes = 0, memory_budget_bytes = 0;
  std::uint64_t peak_points = 0;  ///< most points in the window, in all sweeps
  double mean_points = 0;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> series;  ///< points read (continued from sweep to sweep), points
                                                                ///< active
  /// For each operator, or step of the engine: pairs of points read and points in its buffer.
  std::vector<std::pair<std::string, std::vector<std::pair<std::uint64_t, std::uint64_t>>>> buffers;
  double lifespan_mean_seconds = 0, lifespan_max_seconds = 0;
  std::optional<ReferenceCounts> reference;  ///< counts of a run by the paper's algorithm; absent for other runs
  /// Neighbour distances of the first sweep, eight bins for each octave; empty unless the tool runs with --report.
  std::vector<DistanceBin> neighbor_distances;
  unsigned threads = 1;
  std::string machine;
  std::vector<std::string> warnings;  ///< sentences of Observer::on_warning() and, except estimates, on_note()
};

/// Returns one JSON object; series are thinned to at most 1,000 rows.
POINTSWEEP_EXPORT std::string to_json(const Statistics& statistics);

}  // namespace pointsweep
