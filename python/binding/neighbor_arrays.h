// SPDX-License-Identifier: MIT
/// The k nearest neighbours, written straight into the arrays that Python gets.
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "pointsweep/operator.h"
#include "pointsweep/writer.h"
#include "python/binding/result_arrays.h"

namespace pointsweep {

/// Makes "neighbor_count", u32, and writes rows and distances of the neighbours to arrays of its own, at the row of the
/// point: they are in memory once. That it may see a point twice does no harm: the list of a point is the same each
/// time. Both arrays have the bytes of operators::neighbors().
class NeighborArrays final : public Operator {
 public:
  NeighborArrays(std::size_t k, std::uint64_t points);
  std::string name() const override { return "neighbor_arrays"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;

  /// For Outputs::writer: marks the rows of points that have no neighbours as missing. *this outlives the run.
  std::unique_ptr<Writer> writer(const OutputPlan& plan);
  /// After the run: (rows u32 or u64, distances f64), both N×k for the N points of the output. Empties *this.
  nanobind::tuple arrays();

 private:
  class EmptyRows;
  template <class Row>
  void write(const Neighborhoods& in, Row* rows, double* distances) const;

  std::size_t k_;
  Type row_type_;
  std::uint64_t count_ = 0;  ///< of points in the output
  ArrayMemory rows_, distances_;
};

}  // namespace pointsweep
