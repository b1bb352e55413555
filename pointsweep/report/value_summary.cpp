// SPDX-License-Identifier: MIT
#include "pointsweep/report/value_summary.h"

#include <algorithm>
#include <cmath>

namespace pointsweep {
namespace {

constexpr std::size_t kBins = 48;
constexpr double kPercents[] = {0, 5, 25, 50, 75, 95, 100};
constexpr double kLargestWhole = 1e15;  ///< beyond it, whole numbers are not all doubles
constexpr double kBeyond = 0.5;  ///< per cent on either side that the bins at the ends hold

/// The value that so many per cent of the ascending ones do not exceed.
double percentile(const std::vector<double>& sorted, double percent) {
  const double last = static_cast<double>(sorted.size() - 1);
  return sorted[static_cast<std::size_t>(std::lround(percent / 100 * last))];
}

void fill_bins(const std::vector<double>& sorted, bool whole, ValueSummary& summary) {
  double lo = percentile(sorted, kBeyond), hi = percentile(sorted, 100 - kBeyond);
  std::size_t bins = kBins;
  if (whole && hi - lo < kBins && std::max(-lo, hi) < kLargestWhole) {
    lo -= 0.5, hi += 0.5;
    bins = static_cast<std::size_t>(hi - lo);
  } else if (!(hi > lo)) {
    const double half = lo == 0 ? 0.5 : 0.5 * std::abs(lo);
    lo -= half, hi += half;
  }
  const double width = (hi - lo) / static_cast<double>(bins);
  for (std::size_t i = 0; i <= bins; ++i) summary.edges.push_back(lo + width * static_cast<double>(i));
  summary.counts.assign(bins, 0);
  for (const double v : sorted) {
    const double bin = std::clamp(std::floor((v - lo) / width), 0.0, static_cast<double>(bins - 1));
    ++summary.counts[static_cast<std::size_t>(bin)];
  }
}

ValueSummary summary_of(const Field& field, std::size_t stride, std::span<const std::byte> records) {
  ValueSummary summary{.name = field.name};
  std::vector<double> sorted;
  for (std::size_t at = 0; at + stride <= records.size(); at += stride) {
    const double v = value_of(field, records.data() + at);
    ++summary.values;
    std::isfinite(v) ? sorted.push_back(v) : void(++summary.undefined);
  }
  if (sorted.empty()) return summary;
  std::ranges::sort(sorted);
  std::ranges::transform(kPercents, summary.percentiles.begin(), [&](double p) { return percentile(sorted, p); });
  const bool whole = std::ranges::all_of(sorted, [](double v) { return v == std::floor(v); });
  fill_bins(sorted, whole, summary);
  return summary;
}

}  // namespace

std::vector<ValueSummary> value_summaries(const Schema& schema, std::span<const std::byte> records,
                                          std::span<const std::string> fields) {
  std::vector<ValueSummary> summaries;
  for (const Field& field : schema.fields)
    if (field.count == 1 && std::ranges::find(fields, field.name) != fields.end())
      summaries.push_back(summary_of(field, schema.stride, records));
  return summaries;
}

}  // namespace pointsweep
