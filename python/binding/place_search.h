// SPDX-License-Identifier: MIT
/// Neighbours of places that are no points of the cloud.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators/nearest/cell_point.h"
#include "python/binding/array_columns.h"

namespace pointsweep {

/// Neighbours of places, in their order: those of places[i] are the next counts[i] of `neighbors`, nearest first.
struct PlaceLists {
  std::span<const std::size_t> places;
  std::span<const std::size_t> counts;
  std::span<const CellNeighbor> neighbors;
};

/// Puts the points of a run into cells, and then asks for the neighbours of each place. Makes "neighbor_queries", u8,
/// without a meaning: a stage that makes nothing would not be run. A place that is not finite has no neighbours, and is
/// not among those handed over. Memory for places: 16 bytes for each, and that of some ten thousand at once.
class PlaceSearch final : public InOrderOperator {
 public:
  /// Called from any number of threads at once; a place may come twice, with the same neighbours, if there is a k.
  using Take = std::function<void(const PlaceLists&)>;

  /// `places`: N×3 numbers, which outlive the run. `k`: of neighbours, at most; nothing: all within the radius.
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
