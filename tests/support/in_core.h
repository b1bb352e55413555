// SPDX-License-Identifier: MIT
/// Applies an operator to a cloud held in memory, without the engine: the reference run of operator tests.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <span>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/neighborhood.h"
#include "pointsweep/operator.h"
#include "pointsweep/points/degenerate_points.h"

namespace pointsweep {

/// One column of raw values for each attribute that an operator makes, and its degenerate points.
struct InCoreResult {
  std::vector<std::vector<std::byte>> columns;
  std::uint64_t degenerate = 0;
  std::vector<std::uint64_t> degenerate_rows = {};  ///< ascending

  template <class T>
  std::vector<T> column(std::size_t m) const {
    std::vector<T> values(columns[m].size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), columns[m].data(), columns[m].size());
    return values;
  }
};

/// A cloud cut by row into cells of `cell_points`, with neighbour lists by row and input columns shared by all
/// operators. `moved`: true if the lists were found before the points were moved.
class InCoreCloud {
 public:
  InCoreCloud(std::span<const Vec3> points, const std::vector<std::vector<std::uint32_t>>& neighbors,
              std::size_t cell_points = kCellCapacity, bool moved = false)
      : cell_points_(cell_points), moved_(moved), neighbors_(neighbors), row_(points.size()) {
    for (const Vec3 p : points) x_.push_back(p.x), y_.push_back(p.y), z_.push_back(p.z);
    std::iota(row_.begin(), row_.end(), std::uint64_t{0});
  }

  /// Applies an operator to all points. `reads` and `reads_neighbors`: a column of values, one per point, for every
  /// attribute that the contract reads.
  InCoreResult apply(const LocalOperator& op, std::span<const std::vector<std::byte>> reads = {},
                     std::span<const std::vector<std::byte>> reads_neighbors = {}) const {
    const Contract contract = op.contract();
    std::vector<const std::vector<std::byte>*> inputs;
    std::vector<std::size_t> width;
    for (std::size_t a = 0; a < reads.size(); ++a)
      inputs.push_back(&reads[a]), width.push_back(contract.reads[a].bytes());
    for (std::size_t a = 0; a < reads_neighbors.size(); ++a)
      inputs.push_back(&reads_neighbors[a]), width.push_back(contract.reads_neighbors[a].bytes());
    std::vector<std::uint16_t> numbers(inputs.size());
    std::iota(numbers.begin(), numbers.end(), std::uint16_t{0});

    InCoreResult result;
    for (const Attribute& made : contract.makes) result.columns.emplace_back(row_.size() * made.bytes());
    const std::size_t cells = (row_.size() + cell_points_ - 1) / cell_points_;
    std::vector<const std::byte*> pointers(cells * inputs.size());
    std::vector<PointColumns> slots;
    for (std::size_t c = 0; c < cells; ++c) {
      const std::size_t first = c * cell_points_;
      for (std::size_t a = 0; a < inputs.size(); ++a)
        pointers[c * inputs.size() + a] = inputs[a]->data() + first * width[a];
      slots.push_back({&x_[first], &y_[first], &z_[first], &row_[first], pointers.data() + c * inputs.size()});
    }
    for (std::size_t c = 0; c < cells; ++c) {
      const std::size_t first = c * cell_points_, size = std::min(cell_points_, row_.size() - first);
      std::vector<std::uint32_t> begin{0};
      std::vector<NeighborRef> refs;
      for (std::size_t i = first; i < first + size; ++i) {
        for (const std::uint32_t row : neighbors_[i])
          refs.push_back(make_ref(std::uint32_t(row / cell_points_), std::uint32_t(row % cell_points_)));
        begin.push_back(std::uint32_t(refs.size()));
      }
      std::vector<std::byte*> made;
      for (std::size_t m = 0; m < result.columns.size(); ++m)
        made.push_back(result.columns[m].data() + first * contract.makes[m].bytes());
      const std::span all(numbers);
      const Neighborhoods in(slots[c], size, slots.data(), begin.data(), refs.data(), all.first(reads.size()),
                             all.subspan(reads.size()), -1, moved_);
      DegeneratePoints degenerate;
      Columns out(made, size, degenerate);
      op.apply(in, out);
      result.degenerate += degenerate.count();
      degenerate.for_each([&](std::size_t i) { result.degenerate_rows.push_back(first + i); });
    }
    return result;
  }

 private:
  std::size_t cell_points_;
  bool moved_;
  std::vector<std::vector<std::uint32_t>> neighbors_;
  std::vector<double> x_, y_, z_;
  std::vector<std::uint64_t> row_;
};

}  // namespace pointsweep
