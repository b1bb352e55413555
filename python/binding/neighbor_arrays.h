// SPDX-License-Identifier: MIT
/// The k nearest neighbours, written straight into the arrays that Python gets.
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <cstdint>
#include <memory>

#include "pointsweep/operator.h"
#include "pointsweep/writer.h"
#include "python/binding/result_arrays.h"

namespace pointsweep {

/// Rows and distances of the neighbours of all points of a run, at the row of the point, so that they are in memory
/// once. Both arrays have the bytes of operators::neighbors().
class NeighborArrays {
 public:
  NeighborArrays(std::size_t k, std::uint64_t points);

  /// An operator that makes "neighbor_count", u32, and writes the neighbours of each point to *this, which outlives it.
  /// A point may come twice, with the same neighbours.
  std::shared_ptr<const LocalOperator> op();
  /// For Outputs::writer: marks the rows of points that have no neighbours as missing. *this outlives the run.
  std::unique_ptr<Writer> writer(const OutputPlan& plan);
  /// After the run: (rows u32 or u64, distances f64), both N×k for the N points of the output. Empties *this.
  nanobind::tuple arrays();

 private:
  class EmptyRows;
  void write(const Neighborhoods& in);
  template <class Row>
  void write(const Neighborhoods& in, Row* rows, double* distances) const;

  std::size_t k_;
  Type row_type_;
  std::uint64_t count_ = 0;  ///< of points in the output
  ArrayMemory rows_, distances_;
};

}  // namespace pointsweep
