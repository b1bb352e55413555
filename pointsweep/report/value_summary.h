// SPDX-License-Identifier: MIT
/// The numbers that a run has made, in few words and a histogram.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/points/schema.h"

namespace pointsweep {

struct ValueSummary {
  std::string name = {};        ///< name of the field, e.g. "nx" or "mean_curvature"
  std::string unit = {};        ///< e.g. "1/m"; empty: none, or not known
  std::uint64_t values = 0;     ///< number of values that were looked at
  std::uint64_t undefined = 0;  ///< NaN and infinite ones among `values`
  /// Least, 5 %, 25 %, 50 %, 75 %, 95 %, greatest of the others.
  std::array<double, 7> percentiles{};
  /// Bin i is edges[i] .. edges[i + 1]; the first and the last also hold what lies beyond. Empty without a value.
  std::vector<double> edges = {}, counts = {};
};

/// Returns a summary of each field with one number a point; fields with several numbers are left out. Bins are equally
/// wide over the middle 99 % of the values. Whole numbers get a bin each if there are few of them.
std::vector<ValueSummary> value_summaries(const Schema& schema, std::span<const std::byte> records,
                                          std::span<const std::string> fields);

}  // namespace pointsweep
