// SPDX-License-Identifier: MIT
#include "pointsweep/raster/cells.h"

#include <algorithm>

namespace pointsweep {
namespace {

constexpr std::size_t kLeastNumbers = 1 << 16;

/// Returns the number of cells from `from` to the larger number `to`, at most `most`.
std::size_t step(double from, double to, std::size_t most) {
  return to - from < static_cast<double>(most) ? static_cast<std::size_t>(to - from) : most;
}

}  // namespace

bool BandedRows::begins_band(double number) const {
  return any_ && number - number_ >= static_cast<double>(rule_.most);
}

std::uint64_t BandedRows::place_of(double number) {
  const bool begins = begins_band(number);
  if (begins) ++band_;
  place_ = any_ && !begins ? place_ + static_cast<std::uint64_t>(number - number_) : rule_.margin;
  number_ = number;
  any_ = true;
  return place_;
}

void CellAxis::add(double number) {
  if (!added_.empty() && added_.back() == number) return;
  added_.push_back(number);
  if (added_.size() >= std::max(kLeastNumbers, runs_.size())) merge();
}

/// Merges the added numbers and the runs into ascending runs.
void CellAxis::merge() {
  std::vector<Run> all = std::move(runs_);
  for (const double number : added_) all.push_back({number, number});
  added_.clear();
  std::ranges::sort(all, {}, &Run::first);
  runs_.clear();
  for (const Run& run : all) {
    if (!runs_.empty() && run.first - runs_.back().last <= 1)
      runs_.back().last = std::max(runs_.back().last, run.last);
    else
      runs_.push_back(run);
  }
}

void CellAxis::finish() {
  merge();
  if (runs_.empty()) return;
  runs_.front().place = rule_.margin;
  const auto end = [](const Run& run) { return run.place + static_cast<std::size_t>(run.last - run.first); };
  for (std::size_t r = 1; r < runs_.size(); ++r)
    runs_[r].place = end(runs_[r - 1]) + step(runs_[r - 1].last, runs_[r].first, rule_.most);
  size_ = end(runs_.back()) + rule_.margin + 1;
}

std::size_t CellAxis::place_of(double number) const {
  const auto behind = std::ranges::upper_bound(runs_, number, {}, &Run::first);
  const Run& run = *(behind - 1);
  return run.place + static_cast<std::size_t>(number - run.first);
}

}  // namespace pointsweep
