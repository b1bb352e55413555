// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/worker.h"

#include "pointsweep/order/fixed_copy.h"

namespace pointsweep {

void ChosenPoints::take(const SweepPlan& plan, const Cell& cell, const CellSubset& points,
                        const std::byte* const* columns) {
  chosen_.clear();
  for (std::uint32_t n = 0; n < points.size(); ++n) chosen_.push_back(points[n]);
  x_.clear(), y_.clear(), z_.clear(), row_.clear();
  for (const std::uint32_t i : chosen_) {
    x_.push_back(cell.x[i]), y_.push_back(cell.y[i]), z_.push_back(cell.z[i]), row_.push_back(cell.row[i]);
  }
  columns_.resize(plan.column_bytes.size());
  pointers_.assign(plan.column_bytes.size(), nullptr);
  for (std::size_t c = 0; c < plan.column_bytes.size(); ++c) {
    if (columns[c] == nullptr) continue;
    const std::uint32_t bytes = plan.column_bytes[c];
    columns_[c].resize(chosen_.size() * bytes);
    pointers_[c] = columns_[c].data();
    with_fixed_size(bytes, [&](auto size) {
      for (std::size_t n = 0; n < chosen_.size(); ++n)
        copy_bytes<size()>(pointers_[c] + n * bytes, columns[c] + std::size_t{chosen_[n]} * bytes, bytes);
    });
  }
}

void ChosenPoints::make_columns(const SweepPlan& plan, std::size_t step) {
  for (std::size_t s = plan.steps[step]; s < plan.steps[step + 1]; ++s) {
    for (const std::uint16_t c : plan.stages[s].makes) {
      if (pointers_[c] != nullptr) continue;
      columns_[c].assign(chosen_.size() * plan.column_bytes[c], std::byte{0});
      pointers_[c] = columns_[c].data();
    }
  }
}

void ChosenPoints::give_back(const SweepPlan& plan, std::size_t step, std::byte* const* columns) const {
  for (std::size_t s = plan.steps[step]; s < plan.steps[step + 1]; ++s) {
    for (const std::uint16_t c : plan.stages[s].makes) {
      if (columns[c] == nullptr) continue;
      const std::uint32_t bytes = plan.column_bytes[c];
      with_fixed_size(bytes, [&](auto size) {
        for (std::size_t n = 0; n < chosen_.size(); ++n)
          copy_bytes<size()>(columns[c] + std::size_t{chosen_[n]} * bytes, pointers_[c] + n * bytes, bytes);
      });
    }
  }
}

}  // namespace pointsweep
