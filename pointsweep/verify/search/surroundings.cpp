// SPDX-License-Identifier: MIT
#include "pointsweep/verify/search/surroundings.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

constexpr std::size_t kMostPoints = std::size_t{1} << 28;

/// Returns the square of the sum of two lengths, given their squares, rounded up.
double square_of_sum(double a2, double b2) {
  const double sum = (std::sqrt(a2) + std::sqrt(b2)) * (1 + 1e-9) + 1e-150;
  return sum * sum;
}

/// The distinct positions ("places") of points. Points at one place have the same nearest points, apart from the point
/// itself.
struct Places {
  std::vector<Vec3> position;
  std::vector<double> reach2;
  std::vector<std::size_t> of_point;  ///< place of each point of the ring
};

class Finder {
 public:
  Finder(RowSource& in, const NeighborRule& rule, const PhaseProgress& progress)
      : in_(in), rule_(rule), most_(rule.k == NeighborRule::kUnlimited ? rule.k : rule.k + 1), progress_(progress) {
    out_.list_begin = {0};
  }

  Surroundings run(std::span<const KnownPoint> chosen, std::span<const KnownPoint> subset, std::size_t rings) {
    for (const KnownPoint& p : chosen) number_of(p.position, p.row);
    out_.ring_end.push_back(out_.size());
    first_idea_of_reach(subset);
    for (std::size_t ring = 0; ring < rings; ++ring) {
      const std::size_t begin = ring == 0 ? 0 : out_.ring_end[ring - 1];
      add_lists(begin, out_.ring_end[ring]);
      out_.ring_end.push_back(out_.size());
    }
    return std::move(out_);
  }

 private:
  std::uint32_t number_of(Vec3 p, std::uint64_t row) {
    const auto [known, is_new] = numbers_.try_emplace(row, static_cast<std::uint32_t>(out_.size()));
    if (is_new) {
      if (out_.size() >= kMostPoints)
        fail_usage("The sample has too many neighbours to check at once: lower --sample.");
      out_.add(p, row);
      reach2_.push_back(rule_.radius * rule_.radius);
    }
    return known->second;
  }

  Places places_of(std::size_t begin, std::size_t end) const {
    std::vector<std::size_t> order(end - begin);
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = begin + i;
    const auto key = [&](std::size_t i) { return std::tuple(out_.x[i], out_.y[i], out_.z[i]); };
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
    Places places;
    places.of_point.resize(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (i == 0 || key(order[i - 1]) != key(order[i])) {
        places.position.push_back(out_.position(order[i]));
        places.reach2.push_back(reach2_[order[i]]);
      }
      places.of_point[order[i] - begin] = places.position.size() - 1;
      places.reach2.back() = std::min(places.reach2.back(), reach2_[order[i]]);
    }
    return places;
  }

  void first_idea_of_reach(std::span<const KnownPoint> subset) {
    if (most_ == NearestInStream::kAll) return;
    Places places = places_of(0, out_.size());
    const std::vector<double> reach2 = bounds_of_reach2(places.position, std::move(places.reach2), most_, subset);
    for (std::size_t i = 0; i < out_.size(); ++i) reach2_[i] = reach2[places.of_point[i]];
  }

  void add_lists(std::size_t begin, std::size_t end) {
    Places places = places_of(begin, end);
    NearestInStream nearest(std::move(places.position), std::move(places.reach2), most_);
    for_each_position(in_, "searching", progress_, [&](std::uint64_t row, Vec3 p) { nearest.offer(p, row); });
    for (std::size_t i = begin; i < end; ++i) add_list(i, nearest.nearest(places.of_point[i - begin]));
  }

  void add_list(std::size_t i, const std::vector<NearPoint>& nearest) {
    const std::size_t first = out_.neighbors.size();
    double farthest2 = 0;
    for (const NearPoint& p : nearest) {
      if (p.row == out_.row[i] || out_.neighbors.size() - first == rule_.k) continue;
      farthest2 = p.distance2;
      out_.neighbors.push_back(number_of(p.position, p.row));
    }
    out_.list_begin.push_back(out_.neighbors.size());
    if (out_.neighbors.size() - first < rule_.k) return;
    // The triangle inequality bounds the neighbourhood of each neighbour j, since this point and its other neighbours
    // are k points near j.
    for (std::size_t n = first; n < out_.neighbors.size(); ++n) {
      const std::uint32_t j = out_.neighbors[n];
      reach2_[j] = std::min(reach2_[j], square_of_sum(distance2(out_.position(i), out_.position(j)), farthest2));
    }
  }

  RowSource& in_;
  const NeighborRule rule_;
  const std::size_t most_;  ///< number of points to find for each place, including a point at the place itself
  const PhaseProgress& progress_;
  Surroundings out_;
  std::unordered_map<std::uint64_t, std::uint32_t> numbers_;  ///< number of a point by its row
  std::vector<double> reach2_;  ///< for each point, the squared bound of its neighbours' distances
};

}  // namespace

Surroundings find_surroundings(RowSource& in, std::span<const KnownPoint> chosen, std::span<const KnownPoint> subset,
                               const NeighborRule& rule, std::size_t rings, const PhaseProgress& progress) {
  return Finder(in, rule, progress).run(chosen, subset, rings);
}

}  // namespace pointsweep
