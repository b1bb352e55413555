// SPDX-License-Identifier: MIT
#include "pointsweep/order/splitters.h"

#include <cassert>
#include <cmath>
#include <limits>

#include "pointsweep/math/sort.h"

namespace pointsweep {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr std::size_t kCellsPerLimit = 16, kMostLookupCells = 65536;
constexpr double kThinnest = 4;  ///< least thickness of a piece, in median spacings of its points

/// Returns the median spacing at 255 evenly chosen points of the sample, or at all of them if there are fewer.
double median_spacing(std::span<const std::pair<double, double>> sample) {
  constexpr std::size_t kLook = 255;
  std::vector<double> spacings;
  const std::size_t every = sample.size() / kLook + 1;
  for (std::size_t i = 0; i < sample.size(); i += every) spacings.push_back(sample[i].second);
  const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
  std::nth_element(spacings.begin(), middle, spacings.end());
  return *middle;
}

}  // namespace

Splitters::Splitters(std::vector<double> limits) : limits_(std::move(limits)) {
  assert(std::ranges::adjacent_find(limits_, std::greater_equal<>()) == limits_.end());
  assert(limits_.size() < std::numeric_limits<std::uint16_t>::max());
  const std::size_t cells = std::clamp<std::size_t>(limits_.size() * kCellsPerLimit, 1, kMostLookupCells);
  last_cell_ = static_cast<double>(cells - 1);
  if (limits_.size() > 1) {
    lo_ = limits_.front();
    scale_ = last_cell_ / (limits_.back() - limits_.front());
  }
  first_.assign(cells + 1, 0);
  for (const double limit : limits_) ++first_[cell_of(limit) + 1];
  for (std::size_t c = 1; c <= cells; ++c) first_[c] = static_cast<std::uint16_t>(first_[c] + first_[c - 1]);
  limits_.push_back(kInf);
}

std::uint32_t Splitters::search(std::size_t cell, double value) const {
  const auto begin = limits_.begin();
  return static_cast<std::uint32_t>(std::upper_bound(begin + first_[cell], begin + first_[cell + 1], value) - begin);
}

std::vector<double> quantile_limits(std::vector<double>& sample, std::size_t pieces) {
  sort_ascending(std::span(sample));
  std::vector<double> limits;
  double previous = kInf;
  for (std::size_t i = 1; i < pieces && !sample.empty(); ++i) {
    const double quantile = sample[i * sample.size() / pieces];
    if (quantile != previous && (limits.empty() || quantile > limits.back()))
      limits.push_back(quantile);
    else if (quantile == previous && limits.back() == quantile)
      limits.push_back(std::nextafter(quantile, kInf));
    previous = quantile;
  }
  return limits;
}

std::vector<double> limits_not_too_near(std::span<const double> limits, std::span<const double> sample,
                                        std::span<const double> spacing) {
  if (spacing.empty()) return {limits.begin(), limits.end()};
  std::vector<std::pair<double, double>> sorted;
  for (std::size_t i = 0; i < sample.size(); ++i) sorted.emplace_back(sample[i], spacing[i]);
  sort_ascending(std::span(sorted));
  std::vector<double> kept;
  auto begin = sorted.begin(), end = begin;
  for (const double limit : limits) {
    end = std::partition_point(end, sorted.end(), [limit](const auto& s) { return s.first < limit; });
    if (begin == end || limit - begin->first < kThinnest * median_spacing({begin, end})) continue;
    kept.push_back(limit);
    begin = end;
  }
  return kept;
}

}  // namespace pointsweep
