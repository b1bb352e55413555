// SPDX-License-Identifier: MIT
/// What a run did, for people, programs and plots.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace pointsweep {

struct Statistics {
  std::uint64_t points = 0;
  std::uint64_t k = 0;           ///< 0: no limit
  std::uint64_t certified = 0;   ///< neighbourhoods proven exact: all finite points
  std::uint64_t recalled = 0;    ///< of these, by reading a part of the stream again
  std::uint64_t degenerate = 0;  ///< results that got the documented value for want of data
  std::uint64_t nonfinite = 0;   ///< points with NaN or infinite coordinates
  double total_seconds = 0;      ///< wall
  double order_seconds = 0;      ///< wall: survey and distribution
  double read_seconds = 0;       ///< loading and cutting slabs, summed over threads
  double search_seconds = 0;     ///< summed over threads
  double write_seconds = 0;      ///< wall: bringing the results into the output
  std::vector<std::pair<std::string, double>> operator_seconds;  ///< summed over threads
  std::uint64_t bytes_read = 0, bytes_spilled = 0, bytes_written = 0;
  std::uint64_t peak_rss_bytes = 0, memory_budget_bytes = 0;
  std::uint64_t peak_points = 0;
  double mean_points = 0;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> series;  ///< points read, points active
  double lifespan_mean_seconds = 0, lifespan_max_seconds = 0;
  unsigned threads = 1;
  std::string machine;
  std::vector<std::string> warnings;
};

/// One JSON object; the series thinned to at most 1,000 rows.
std::string to_json(const Statistics& statistics);

/// "Intel(R) Xeon(R) Processor, 2 cores"
std::string machine_description();
/// Largest resident set of this process so far, in bytes.
std::uint64_t peak_resident_bytes();

}  // namespace pointsweep
