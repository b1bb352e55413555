// SPDX-License-Identifier: MIT
#include "python/binding/place_search.h"

#include <algorithm>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/geometry.h"
#include "pointsweep/math/sort.h"
#include "pointsweep/operators/nearest/point_cells.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {
namespace {

/// Number of places, consecutive along the axis, whose neighbours are searched at once.
constexpr std::size_t kPlacesAtOnce = 1 << 16;

Vec3 place_at(const ArrayColumn& places, std::size_t i) {
  const Field number{.name = "", .type = places.type};
  Vec3 place;
  for (int a = 0; a < 3; ++a)
    place[a] =
        value_of(number, places.first + static_cast<std::ptrdiff_t>(i) * places.row_stride + a * places.value_stride);
  return place;
}

}  // namespace

class PlaceSearch::Work final : public InOrderWork {
 public:
  Work(const PlaceSearch& search, const InOrderSetup& setup)
      : search_(search),
        axis_(setup.axis),
        cells_(PointCells::Space::all, setup.axis, setup.memory_bytes, setup.make_scratch()) {}

  void add(unsigned, const OrderedPoints& points, Findings&) override { cells_.add(points.positions, points.rows); }

  void end(unsigned, Findings&) override {
    cells_.finish();
    const std::vector<std::pair<double, double>> order = along_axis();
    for (std::size_t first = 0; first < order.size(); first += kPlacesAtOnce) {
      stop_if_cancelled();
      numbers_.clear(), places_.clear();
      for (std::size_t i = first; i < std::min(order.size(), first + kPlacesAtOnce); ++i) {
        numbers_.push_back(static_cast<std::size_t>(order[i].second));
        places_.push_back(place_at(search_.places_, numbers_.back()));
      }
      search_.k_ ? find_nearest(*search_.k_) : find_within();
    }
  }

 private:
  /// Returns the coordinates of the finite places along the axis, ascending, with the numbers of the places.
  std::vector<std::pair<double, double>> along_axis() const {
    std::vector<std::pair<double, double>> order;
    order.reserve(search_.places_.rows);
    for (std::size_t i = 0; i < search_.places_.rows; ++i) {
      const Vec3 place = place_at(search_.places_, i);
      if (is_finite(place)) order.emplace_back(place[axis_], static_cast<double>(i));
    }
    sort_ascending(order);
    return order;
  }

  void find_nearest(std::size_t k) {
    cells_.nearest_of_all(places_, {.k = k, .most2 = search_.radius_ * search_.radius_},
                          [&](std::size_t i, const std::vector<CellNeighbor>& found) {
                            const std::size_t count = found.size();
                            search_.take_({std::span(&numbers_[i], 1), std::span(&count, 1), found});
                          });
  }

  void find_within() {
    cells_.nearest_within(places_, search_.radius_, [&](PointCells::WithinPlaces found) {
      for (std::size_t& place : found.places) place = numbers_[place];
      search_.take_({found.places, found.counts, found.neighbors});
    });
  }

  const PlaceSearch& search_;
  int axis_;
  PointCells cells_;
  std::vector<std::size_t> numbers_;  ///< numbers of the places that are searched at the same time
  std::vector<Vec3> places_;
};

InOrderContract PlaceSearch::in_order_contract() const {
  return {.makes = {scalar("neighbor_queries", Type::u8, "1", "nothing")}, .arrival = "for the search of the queries"};
}

std::unique_ptr<InOrderWork> PlaceSearch::start(const InOrderSetup& setup) const {
  return std::make_unique<Work>(*this, setup);
}

std::uint64_t PlaceSearch::least_bytes(const CloudEstimate&) const {
  return PointCells::least_bytes() + places_.rows * sizeof(std::pair<double, double>) +
         kPlacesAtOnce * (sizeof(std::size_t) + sizeof(Vec3) + 2 * sizeof(CellPoint));
}

}  // namespace pointsweep
