// SPDX-License-Identifier: MIT
/// The numbers and sizes of the connected components of graphs over the whole cloud.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/verify/formulas/joined_sets.h"
#include "pointsweep/verify/values/cloud_formula.h"

namespace pointsweep {

/// The labels of items, which are points or places, looked up by the row of a point.
struct LabelsOfRows {
  std::vector<std::uint32_t> item_of_row;
  formulas::SetLabels labels;

  /// Returns two estimates for each point: the number of its component, and the size of the component.
  std::vector<Estimates> of(std::span<const CloudPoint> points) const;
};

/// Throws NotTold if a rule shortens neighbourhoods.
void require_plain_neighbors(const CloudInput& in);

/// The formula of numbers and sizes of components, from the whole graph. If the graph does not fit in memory, the
/// formula expects that each chosen point has the label that its joined neighbours have in the output.
class LabelFormula : public CloudFormula {
 public:
  void prepare(const CloudInput& in) final;
  std::string limits() const final { return limits_; }
  std::vector<Estimates> evaluate(std::span<const CloudPoint> points, const CloudInput& in) override;

 protected:
  enum class Join { no, yes, as_first /**< the first neighbour with this answer decides alone */ };

  /// Returns whether the whole graph is known.
  bool is_found() const { return limits_.empty(); }
  const LabelsOfRows& found() const { return found_; }
  /// Returns the column of component numbers in the output, then `more`. Throws NotTold if the numbers are not in the
  /// output, or the columns do not fit in memory.
  static std::vector<ColumnSource> label_columns(const CloudInput& in, std::span<const ColumnSource> more = {});

 private:
  virtual LabelsOfRows labels(const CloudInput& in) const = 0;
  /// Returns the columns that joined() and alone() read.
  virtual std::vector<ColumnSource> columns(const CloudInput& in) const = 0;
  /// Returns whether a neighbour has the same label as a point. `point`, `neighbor`: their values in columns().
  virtual Join joined(std::span<const double> point, std::span<const double> neighbor, double distance2) const = 0;
  /// Returns the component number of a point that is joined with no neighbour.
  virtual formulas::Estimate alone(std::span<const double> point) const;
  std::vector<Estimates> labels_of_neighbors(std::span<const CloudPoint> points, const CloudInput& in) const;

  LabelsOfRows found_;
  std::string limits_;
};

}  // namespace pointsweep
