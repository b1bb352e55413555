// SPDX-License-Identifier: MIT
#include "reference/kd_heap.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <deque>
#include <limits>
#include <random>

#include "tests/support/fixed_seed.h"

namespace pointsweep::reference {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// A kD-heap, and a plain list of the points that it should hold.
class Beside {
 public:
  explicit Beside(int axis) : axis_(axis), heap_(axis) {}

  /// Adds a point as the sweep does: first to the sets of all other points, then to the heap.
  void add(Vec3 p, std::uint64_t index, std::size_t k, double radius2) {
    StreamPoint& point = points_.emplace_back(p, index, index, Reach{k, radius2});
    sets_.push_back({Reach{k, radius2}, {}});
    for (StreamPoint* other : held_) {
      point.neighbors.offer(other->as_neighbor_of(p));
      sets_[place(*other)].seen.push_back(point.as_neighbor_of(other->input));
      sets_.back().seen.push_back(other->as_neighbor_of(p));
    }
    heap_.offer_to_all(point);
    heap_.insert(point);
    held_.push_back(&point);
  }

  void pop_smallest() {
    if (held_.empty()) return;
    StreamPoint* smallest = &heap_.smallest();
    heap_.pop_smallest();
    std::erase(held_, smallest);
  }

  void take_passed(double plane) {
    std::vector<StreamPoint*> expected, taken;
    for (StreamPoint* p : held_) {
      const double ahead = plane - p->input[axis_];
      if (p->input[axis_] + std::sqrt(p->neighbors.reach2()) < plane && ahead * ahead > p->neighbors.reach2())
        expected.push_back(p);
    }
    heap_.take_passed(plane, taken);
    for (StreamPoint* p : taken) std::erase(held_, p);
    std::sort(expected.begin(), expected.end());
    std::sort(taken.begin(), taken.end());
    RC_ASSERT(taken == expected);
  }

  void check_nearest(Vec3 p, std::size_t k, double radius2) const {
    NearestSet found({k, radius2});
    heap_.find_nearest(p, found);
    std::vector<Neighbor> all;
    for (StreamPoint* other : held_) all.push_back(other->as_neighbor_of(p));
    expect(found, nearest(all, {k, radius2}));
  }

  void check() const {
    RC_ASSERT(heap_.size() == held_.size());
    RC_ASSERT(heap_.empty() == held_.empty());
    if (held_.empty()) return;
    const auto earlier = [](const StreamPoint* a, const StreamPoint* b) { return a->index < b->index; };
    RC_ASSERT(&heap_.smallest() == *std::min_element(held_.begin(), held_.end(), earlier));
    for (StreamPoint* p : held_) expect(p->neighbors, nearest(sets_[place(*p)].seen, sets_[place(*p)].reach));
  }

 private:
  struct Seen {
    Reach reach;
    std::vector<Neighbor> seen;
  };
  std::size_t place(const StreamPoint& p) const {
    return static_cast<std::size_t>(
        std::find_if(points_.begin(), points_.end(), [&](const StreamPoint& q) { return &p == &q; }) - points_.begin());
  }
  static std::vector<StreamPoint*> nearest(std::vector<Neighbor> all, Reach reach) {
    std::erase_if(all, [&](const Neighbor& n) { return n.distance2 > reach.radius2; });
    std::sort(all.begin(), all.end(), [](const Neighbor& a, const Neighbor& b) { return a.rank() < b.rank(); });
    if (all.size() > reach.k) all.resize(reach.k);
    std::vector<StreamPoint*> points;
    for (const Neighbor& n : all) points.push_back(n.point);
    return points;
  }
  static void expect(NearestSet set, const std::vector<StreamPoint*>& expected) {
    set.sort();
    std::vector<StreamPoint*> found;
    for (const Neighbor& n : set.found()) found.push_back(n.point);
    RC_ASSERT(found == expected);
  }

  int axis_;
  KdHeap heap_;
  std::deque<StreamPoint> points_;
  std::vector<Seen> sets_;
  std::vector<StreamPoint*> held_;
};

/// Generates a point of a coarse grid, so that coordinates and distances tie.
Vec3 grid_point() {
  const auto coordinate = [] { return static_cast<double>(*rc::gen::inRange(0, 7)); };
  return {coordinate(), coordinate(), coordinate()};
}

TEST(KdHeap, HoldsFindsOffersAndTakesWhatAListDoes) {
  EXPECT_TRUE(rc::check([] {
    Beside beside(*rc::gen::inRange(0, 3));
    std::vector<std::uint64_t> indices(*rc::gen::inRange<std::size_t>(1, 80));
    for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = i;
    if (*rc::gen::arbitrary<bool>()) std::shuffle(indices.begin(), indices.end(), std::mt19937(7));
    const std::size_t k = *rc::gen::inRange<std::size_t>(1, 10);
    const double radius2 = *rc::gen::element(kFar, 2.0, 9.0);
    for (const std::uint64_t index : indices) {
      beside.add(grid_point(), index, k, radius2);
      beside.check();
      switch (*rc::gen::inRange(0, 5)) {
        case 0:
          beside.pop_smallest();
          break;
        case 1:
          beside.take_passed(*rc::gen::inRange(0, 9));
          break;
        default:
          beside.check_nearest(grid_point(), *rc::gen::inRange<std::size_t>(1, 10), *rc::gen::element(kFar, 1.0, 4.0));
      }
      beside.check();
    }
  }));
}

TEST(KdHeap, AnswersForTwoThousandPointsThatComeInOrderOrAllInOnePlace) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const bool one_place : {false, true}) {
    std::deque<StreamPoint> points;
    KdHeap heap(2);
    for (std::uint64_t i = 0; i < 2000; ++i) {
      const double t = static_cast<double>(i);
      const Vec3 p = one_place ? Vec3{1, 2, 3} : Vec3{t, t + uniform(random), t};
      heap.insert(points.emplace_back(p, i, i, Reach{4, kFar}));
    }
    NearestSet found({3, kFar});
    heap.find_nearest(points[1000].input, found);
    found.sort();
    ASSERT_EQ(found.found().size(), 3u);
    EXPECT_EQ(found.found()[0].point, one_place ? &points[0] : &points[1000]);
    for (std::uint64_t i = 0; i < 2000; ++i, heap.pop_smallest()) ASSERT_EQ(heap.smallest().index, i);
    EXPECT_TRUE(heap.empty());
  }
}

}  // namespace
}  // namespace pointsweep::reference
