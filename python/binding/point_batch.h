// SPDX-License-Identifier: MIT
/// A batch of points with their neighbours as an operator in Python gets it.
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <span>

#include "pointsweep/attribute.h"
#include "pointsweep/neighborhood.h"
#include "pointsweep/operator.h"

namespace pointsweep {

/// The points [first, first + size) of a batch. Every function that returns an object makes a new array, which may be
/// kept. The PointBatch belongs to Python but borrows the points: after end() these functions throw UsageError. Lists
/// of neighbours are padded to width(), the length of the longest one: values with NaN, or 0 for integers, and row
/// numbers as neighbor_rows() says. For an operator declared without neighbours, width() is 0, and the functions about
/// neighbours and counts() throw UsageError.
class PointBatch {
 public:
  /// `contract`: contract of the operator. `in` and `contract` must stay valid until end().
  PointBatch(const Neighborhoods& in, const Contract& contract, std::size_t first, std::size_t size);
  void end() { in_ = nullptr; }

  std::size_t size() const { return size_; }
  std::size_t width() const { return width_; }
  nanobind::object positions() const;                  ///< N×3 f64
  nanobind::object rows() const;                       ///< N i64
  nanobind::object counts() const;                     ///< N i64
  nanobind::object neighbor_positions() const;         ///< N×width×3 f64
  nanobind::object neighbor_rows() const;              ///< N×width i64; a missing neighbour has the largest i64
  nanobind::object own(std::size_t a) const;           ///< attribute a of contract.reads, N or N×m
  nanobind::object of_neighbors(std::size_t a) const;  ///< of contract.reads_neighbors, N×width or N×width×m

 private:
  const Neighborhoods& in() const;
  /// Returns in(). Throws for an operator declared without neighbours.
  const Neighborhoods& in_with_neighbors() const;

  const Neighborhoods* in_;
  bool alone_;
  std::span<const Attribute> reads_, reads_neighbors_;
  std::size_t first_, size_, width_ = 0;
};

}  // namespace pointsweep
