// SPDX-License-Identifier: MIT
/// Search for the neighbours of places: given positions that need not be points of the cloud.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators/nearest/searched_points.h"
#include "python/binding/array_columns.h"

namespace pointsweep {

/// Neighbours of places, one list after another: the next counts[i] elements of `neighbors` belong to the place with
/// the number places[i], nearest first.
struct PlaceLists {
  std::span<const std::size_t> places;
  std::span<const std::size_t> counts;
  std::span<const CellNeighbor> neighbors;
};

/// Stores the points of a run in cells (PointCells), and then searches the neighbours of each place. Makes the
/// attribute "neighbor_queries", u8, because a stage without attributes would not run; its values have no meaning. A
/// place that is not finite has no neighbours and is not passed on. Memory besides the cells: 16 bytes for each place,
/// and 65,536 places at once with their neighbours.
class PlaceSearch final : public InOrderOperator {
 public:
  /// Called by any number of threads at once. If `k` is given, a place may be passed twice, with the same neighbours.
  using Take = std::function<void(const PlaceLists&)>;

  /// `places`: N×3 numbers, which must outlive the run. `k`: largest number of neighbours; absent: all neighbours
  /// within the radius.
  PlaceSearch(const ArrayColumn& places, std::optional<std::size_t> k, double radius, Take take)
      : places_(places), k_(k), radius_(radius), take_(std::move(take)) {}

  std::string name() const override { return "neighbors"; }
  InOrderContract in_order_contract() const override;
  std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const override;
  std::uint64_t least_bytes(const CloudEstimate& cloud) const override;

 private:
  class Work;
  const ArrayColumn& places_;
  std::optional<std::size_t> k_;
  double radius_;
  Take take_;
};

}  // namespace pointsweep
