// SPDX-License-Identifier: MIT
/// Neighbours within a radius as lists of their own lengths.
#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "pointsweep/operator.h"

namespace pointsweep {

/// Makes "neighbor_count", u32, and notes the lists themselves: 16 bytes for each neighbour, in memory. That it may see
/// a point twice does no harm: the list of a point is the same each time.
class RadiusLists final : public Operator {
 public:
  std::string name() const override { return "radius_lists"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;

  /// After the run: (offsets i64 N+1, rows u32 or u64, distances f64); the neighbours of point i, nearest first, are
  /// those from offsets[i] up to offsets[i + 1]. Empties *this.
  nanobind::tuple arrays(std::uint64_t points);

 private:
  /// The lists of a batch, one after another.
  struct Batch {
    std::vector<std::uint64_t> points;
    std::vector<std::uint32_t> counts;
    std::vector<std::uint64_t> rows;  ///< of neighbours
    std::vector<double> distances;
  };
  template <class Row>
  nanobind::tuple joined(std::uint64_t points, Type type);

  mutable std::mutex mutex_;
  mutable std::vector<Batch> batches_;
};

}  // namespace pointsweep
