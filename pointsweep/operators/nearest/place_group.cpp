// SPDX-License-Identifier: MIT
#include "pointsweep/operators/nearest/place_group.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/free_memory.h"
#include "pointsweep/operators/nearest/place_group.h"

namespace pointsweep {
namespace {

/// kFewPlaces: groups of at most so many places are not halved. kFewPoints: a part with at most so many points, or
/// with at most k points, is not halved: all of its places are compared with all points.
constexpr std::size_t kFewPlaces = 8, kFewPoints = 12;
/// Largest number of points collected for a group; with more, the group is halved first. A collection in vain costs
/// little, because most of its points belong to cells that are read anyway.
constexpr std::size_t kMostCollected = 32768;
/// one_by_one() gives up if its searches visit too many points on average. The average includes this many searches of 0
/// points, so that a few long searches at the beginning are no reason to give up.
constexpr std::size_t kFirstSearches = 16;
constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();

/// Returns the number of points that a search may visit on average. Searches from places among the points visit fewer.
std::size_t most_seen(std::size_t k) { return 64 + 8 * k; }

}  // namespace

bool PlaceGroup::answer(PointCells::View& view, const Use& use) {
  if (!tree_) {
    const Outcome outcome = one_by_one(0, places_.size(), most_seen(wanted_.k), view, use);
    if (outcome != Outcome::takes_long) return outcome == Outcome::done;
    tree_.emplace(places_, HalvedBoxes::levels_for(places_.size(), kFewPlaces), false);
    done_.assign(places_.size(), false);  // the tree has reordered the places
    open_ = {{0, 0}};
  }
  for (const Part part : std::exchange(open_, {})) search(part, view, use);
  free_memory_of(points_);
  return open_.empty();
}

void PlaceGroup::search(Part part, PointCells::View& view, const Use& use) {
  const std::size_t begin = tree_->begin(part.level, part.j), end = tree_->begin(part.level, part.j + 1);
  Outcome outcome = one_by_one(begin, end, most_seen(wanted_.k), view, use);
  if (outcome == Outcome::takes_long) {
    const auto collected = collect(tree_->box(part.level, part.j), view);
    if (collected == PointCells::View::Collected::all) return narrow(part, points_.size(), use);
    if (collected == PointCells::View::Collected::lacks_cells)
      outcome = Outcome::lacks_cells;
    else if (part.level == tree_->levels())
      outcome = one_by_one(begin, end, kAny, view, use);
  }
  if (outcome == Outcome::lacks_cells) open_.push_back(part);
  if (outcome != Outcome::takes_long) return;
  for (const std::size_t half : {0, 1}) search({part.level + 1, 2 * part.j + half}, view, use);
}

PlaceGroup::Outcome PlaceGroup::one_by_one(std::size_t begin, std::size_t end, std::size_t most, PointCells::View& view,
                                           const Use& use) {
  Outcome outcome = Outcome::done;
  std::size_t searches = kFirstSearches, seen = 0;
  NearestWanted wanted = wanted_;
  if (most != kAny) wanted.most_seen = kFirstSearches * most;
  for (std::size_t i = begin; i < end; ++i) {
    if (done_[i]) continue;
    const std::vector<CellNeighbor>* const found = view.nearest(places_[i].position, wanted);
    seen += view.seen();
    if (view.seen() >= wanted.most_seen || seen / ++searches > most) return Outcome::takes_long;
    if (found != nullptr) use(places_[i].row, *found);
    done_[i] = found != nullptr;
    if (found == nullptr) outcome = Outcome::lacks_cells;
  }
  return outcome;
}

/// Collects the points that may be among the nearest of a place. The bound comes from the k points nearest to the
/// middle of the places. If fewer than k points are within reach of any place, all of them are collected.
PointCells::View::Collected PlaceGroup::collect(const Box& places, PointCells::View& view) {
  NearestWanted of_middle = wanted_;
  const double most = (std::sqrt(wanted_.most2) + places.diagonal()) * (1 + 0x1p-20);
  of_middle.most2 = most * most;
  const std::vector<CellNeighbor>* const found = view.nearest(places.center(), of_middle);
  if (found == nullptr) return PointCells::View::Collected::lacks_cells;
  points_.clear();
  for (const CellNeighbor& n : *found) points_.push_back({n.position, n.row});
  if (found->size() < wanted_.k) return PointCells::View::Collected::all;
  Box near;
  for (const CellNeighbor& n : *found) near.include(flat(n.position));
  points_.clear();
  points_.reserve(kMostCollected + 1);
  return view.collect(places, NearestBound(places, near, wanted_.most2), kMostCollected, points_);
}

void PlaceGroup::nearest_of(std::span<const CellPoint> points, Vec3 place, const NearestWanted& wanted) {
  nearest_.begin(wanted);
  for (const CellPoint& p : points) nearest_.see(distance2(flat(p.position), place), p);
}

/// Answers the places of a part from the first `count` points in points_. Each half of the part first moves the points
/// that it needs to the front, so that no points are copied.
void PlaceGroup::narrow(Part part, std::size_t count, const Use& use) {
  stop_if_cancelled();
  const std::span<CellPoint> points = std::span(points_).first(count);
  if (part.level == tree_->levels() || count <= std::max(kFewPoints, wanted_.k)) {
    for (std::size_t i = tree_->begin(part.level, part.j); i < tree_->begin(part.level, part.j + 1); ++i) {
      nearest_of(points, places_[i].position, wanted_);
      use(places_[i].row, nearest_.found());
    }
    return;
  }
  for (const std::size_t j : {2 * part.j, 2 * part.j + 1}) {
    const Part half{part.level + 1, j};
    const Box& box = tree_->box(half.level, half.j);
    nearest_of(points, box.center(), {.k = wanted_.k});
    Box near;
    for (const CellNeighbor& n : nearest_.found()) near.include(flat(n.position));
    const NearestBound bound(box, near, wanted_.most2);
    const auto out =
        std::partition(points.begin(), points.end(), [&](const CellPoint& p) { return !bound.out(flat(p.position)); });
    narrow(half, static_cast<std::size_t>(out - points.begin()), use);
  }
}

}  // namespace pointsweep
