// SPDX-License-Identifier: MIT
/// The k-nearest-neighbour graph itself, as attributes.
#pragma once

#include <cstdint>
#include <string>

#include "pointsweep/operator.h"

namespace pointsweep {

struct OperatorDeclaration;

/// Makes "neighbors", N×k u32 (u64 from 2^32 - 1 rows on): the input rows of the neighbours, nearest first; and, if
/// `distances`, "distances", N×k f64. If a point has fewer than k neighbours, the rest of its k rows are the largest
/// value of the type, and the rest of its distances NaN.
///
/// After an operator that moves points, N_i is still the set that was found before, and its k nearest at the moved
/// positions are written, nearest first at these positions; equal distances go by moved x, y, z, then row. Neighbours
/// moved to a place that is not finite come last, by row.
class NeighborRows : public LocalOperator {
 public:
  NeighborRows(std::size_t k, std::uint64_t rows, bool distances);
  std::string name() const override { return "neighbors"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;

 private:
  template <class Row>
  void write(const Neighborhoods& in, Row* row, double* distance) const;

  std::size_t k_;
  bool wide_;
  bool distances_;
};

/// Returns the declaration for the verb `neighbors`. Pipelines have no such stage, since it needs the k of the
/// neighbourhoods.
OperatorDeclaration neighbor_rows_declaration();

}  // namespace pointsweep
