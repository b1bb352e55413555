// SPDX-License-Identifier: MIT
/// A local check of components of graphs that do not fit in memory: chosen points must have the labels of their
/// neighbours.
#pragma once

#include <span>
#include <vector>

#include "pointsweep/verify/values/cloud_formula.h"

namespace pointsweep {

/// A rule that decides which neighbours have the same label. The rule gets the values of the point and of the neighbour
/// in the columns that it reads.
class JoiningRule {
 public:
  enum class Join { no, yes, as_first /**< the first neighbour with this answer decides alone */ };
  virtual ~JoiningRule() = default;
  virtual Join joined(std::span<const double> point, std::span<const double> neighbor, double distance2) const = 0;
  /// Returns the component number of a point that is joined with no neighbour.
  virtual formulas::Estimate alone(std::span<const double> point) const = 0;
};

/// Returns two estimates for each point: the component number of its joined neighbours in the output, and the size of
/// the component that the output states for the point. `more`: columns that the rule reads.
std::vector<std::vector<formulas::Estimate>> labels_of_neighbors(std::span<const CloudPoint> points,
                                                                 const CloudInput& in,
                                                                 std::span<const ColumnSource> more,
                                                                 const JoiningRule& rule);

/// Returns the column of component numbers, then `more`. Throws NotTold if the numbers are not in the output, or the
/// columns do not fit in memory.
std::vector<ColumnSource> label_columns(const CloudInput& in, std::span<const ColumnSource> more);

}  // namespace pointsweep
