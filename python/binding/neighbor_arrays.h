// SPDX-License-Identifier: MIT
/// The k nearest neighbours, written straight into the arrays that Python gets.
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <cstdint>
#include <memory>

#include "pointsweep/operator.h"
#include "pointsweep/writer.h"
#include "python/binding/place_search.h"
#include "python/binding/result_arrays.h"

namespace pointsweep {

/// Rows and distances of the neighbours of all points of a run, each stored once: neighbour j of the point with the row
/// i, from the nearest, at the index i * k + j. The values equal those that operators::neighbors() makes. For the
/// neighbours of places (place_search.h), i is the number of the place.
class NeighborArrays {
 public:
  NeighborArrays(std::size_t k, std::uint64_t points) : NeighborArrays(k, points, points) {}
  /// Makes arrays for the neighbours of `places` places among `points` points. Places for which put() is not called
  /// have no neighbours.
  static NeighborArrays of_places(std::size_t k, std::uint64_t places, std::uint64_t points);

  /// Returns an operator that makes "neighbor_count", u32, and writes the neighbours of each point to *this, which must
  /// outlive the operator.
  std::shared_ptr<const LocalOperator> op();
  /// Returns a writer for Outputs::writer. It fills the lists of points without neighbours with missing values. *this
  /// must outlive the run.
  std::unique_ptr<Writer> writer(const OutputPlan& plan);
  /// Stores neighbours of places. Called from any number of threads at once, for different places.
  void put(const PlaceLists& lists);
  /// Returns (rows u32 or u64, distances f64) after the run, both N×k for the N points of the output, or the N places.
  /// Empties *this.
  nanobind::tuple arrays();

 private:
  class EmptyRows;
  NeighborArrays(std::size_t k, std::uint64_t lists, std::uint64_t points);
  void write(const Neighborhoods& in);
  template <class Row>
  void write(const Neighborhoods& in, Row* rows, double* distances) const;
  template <class Row>
  void put(const PlaceLists& lists, Row* rows, double* distances) const;

  std::size_t k_;
  Type row_type_;
  std::uint64_t count_ = 0;  ///< number of points in the output, or of places
  ArrayMemory rows_, distances_;
};

}  // namespace pointsweep
