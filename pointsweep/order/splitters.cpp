// SPDX-License-Identifier: MIT
#include "pointsweep/order/splitters.h"

#include <cassert>
#include <cmath>
#include <limits>

namespace pointsweep {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr std::size_t kCellsPerLimit = 16, kMostCells = 65536;

}  // namespace

Splitters::Splitters(std::vector<double> limits) : limits_(std::move(limits)) {
  assert(std::ranges::adjacent_find(limits_, std::greater_equal<>()) == limits_.end());
  assert(limits_.size() < std::numeric_limits<std::uint16_t>::max());
  const std::size_t cells = std::clamp<std::size_t>(limits_.size() * kCellsPerLimit, 1, kMostCells);
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
  std::ranges::sort(sample);
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

}  // namespace pointsweep
