// SPDX-License-Identifier: MIT
/// Neighbours within a radius as lists of their own lengths.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "pointsweep/operator.h"
#include "python/binding/place_search.h"

namespace pointsweep {

/// Lists of neighbours, one for each point of a run or for each place of a search. They are kept in memory: 16 bytes
/// for each neighbour, 12 for each list.
class RadiusLists {
 public:
  RadiusLists() = default;
  RadiusLists(const RadiusLists&) = delete;
  RadiusLists& operator=(const RadiusLists&) = delete;
  ~RadiusLists();

  /// Returns an operator that makes "neighbor_count", u32, and gives the lists of each batch to *this, which must
  /// outlive the operator.
  std::shared_ptr<const LocalOperator> op();

  /// Stores a copy of the lists of places. Called by any number of threads at once.
  void put(const PlaceLists& lists);

  /// Returns (offsets i64 N+1, rows u32 or u64, distances f64) after the run. The neighbours of point or place i,
  /// nearest first, have the indices from offsets[i] up to offsets[i + 1]. `lists`: N, the number of lists. `points`:
  /// number of points of the cloud. Empties *this.
  nanobind::tuple arrays(std::uint64_t lists, std::uint64_t points);

 private:
  /// The lists of a batch. List i, of the point points[i], has the next counts[i] elements of `rows` and `distances`
  /// after those of the lists before it.
  struct Batch {
    std::vector<std::uint64_t> points;  ///< rows of points, or numbers of places
    std::vector<std::uint32_t> counts;
    std::vector<std::uint64_t> rows;  ///< rows of neighbours
    std::vector<double> distances;
    std::unique_ptr<Batch> next;
  };
  static std::unique_ptr<Batch> lists_of(const Neighborhoods& in);
  /// Adds lists. Many threads may call at once, without waiting. The list of a point may be added twice.
  void add(std::unique_ptr<Batch> batch);
  template <class Row>
  nanobind::tuple joined(std::uint64_t lists, Type type);

  std::atomic<Batch*> newest_ = nullptr;  ///< owned by *this; each batch owns the batch that was added before it
};

}  // namespace pointsweep
