// SPDX-License-Identifier: MIT
/// The k-nearest-neighbour graph itself, as attributes.
#pragma once

#include <cstdint>

#include "pointsweep/operators/operator.h"

namespace pointsweep {

/// Makes "neighbors", N×k u32 (u64 from 2^32 - 1 rows on): the input rows of the neighbours, nearest first; and, if
/// asked, "distances", N×k f64 beside it. Where there are fewer than k, the rest is the largest value of the type, and
/// NaN.
class NeighborRows : public Operator {
 public:
  NeighborRows(std::size_t k, std::uint64_t rows, bool distances);
  std::string name() const override { return "neighbors"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;

 private:
  template <class Row>
  void write_rows(const Neighborhoods& in, Row* out) const;

  std::size_t k_;
  bool wide_;
  bool distances_;
};

}  // namespace pointsweep
