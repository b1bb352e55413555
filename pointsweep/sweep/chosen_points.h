// SPDX-License-Identifier: MIT
/// Some points of a cell, copied together: for a rule or a step that not all points of the cell take.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pointsweep/search/cell_subset.h"
#include "pointsweep/sweep/plan.h"

namespace pointsweep {

class ChosenPoints {
 public:
  /// Copies points of the cell, with the columns of the plan whose pointer in `columns` is not null.
  void take(const SweepPlan& plan, const Cell& cell, const CellSubset& points, const std::byte* const* columns);
  /// Gives every column that the step makes and that was not copied a place, filled with 0.
  void make_columns(const SweepPlan& plan, std::size_t step);
  /// Copies what the step has made to the columns that are not null.
  void give_back(const SweepPlan& plan, std::size_t step, std::byte* const* columns) const;

  std::size_t size() const { return chosen_.size(); }
  PointColumns view() const { return {x_.data(), y_.data(), z_.data(), row_.data(), pointers_.data()}; }
  std::byte* const* columns() const { return pointers_.data(); }
  const std::uint64_t* rows() const { return row_.data(); }

 private:
  std::vector<std::uint32_t> chosen_;
  std::vector<double> x_, y_, z_;
  std::vector<std::uint64_t> row_;
  std::vector<std::vector<std::byte>> columns_;
  std::vector<std::byte*> pointers_;
};

}  // namespace pointsweep
