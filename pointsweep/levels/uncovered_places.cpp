// SPDX-License-Identifier: MIT
#include "pointsweep/levels/uncovered_places.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pointsweep/math/box.h"

namespace pointsweep {
namespace {

/// Parts of at most this many places are not halved; each place is tested.
constexpr std::size_t kFewPlaces = 32;

/// Returns the squared distance from a point to the farthest corner of a box, rounded. No place in the box has a
/// greater distance2() from the point.
double farthest2(const Box& box, Vec3 p) {
  const Vec3 far{std::max(p.x - box.lo.x, box.hi.x - p.x), std::max(p.y - box.lo.y, box.hi.y - p.y),
                 std::max(p.z - box.lo.z, box.hi.z - p.z)};
  return (far.x * far.x + far.y * far.y) + far.z * far.z;
}

}  // namespace

std::span<const std::uint32_t> UncoveredPlaces::find(std::span<const Vec3> places, const Box& box,
                                                     const KeptGrid& kept) {
  places_ = places;
  spacing2_ = kept.spacing2();
  uncovered_.clear();
  kept.find_near(box, near_);
  find_in(0, places.size(), 0);
  return uncovered_;
}

void UncoveredPlaces::find_in(std::size_t first, std::size_t count, std::size_t first_near) {
  Box box;
  for (std::size_t i = first; i < first + count; ++i) box.include(places_[i]);
  const std::size_t end_near = near_.size();
  for (std::size_t i = first_near; i < end_near; ++i) {
    const Vec3 p = near_[i];
    if (distance2(box, p) >= spacing2_) continue;
    if (farthest2(box, p) < spacing2_) return near_.resize(end_near);
    near_.push_back(p);
  }
  if (near_.size() == end_near) {
    for (std::size_t i = first; i < first + count; ++i) uncovered_.push_back(static_cast<std::uint32_t>(i));
  } else if (count > kFewPlaces) {
    find_in(first, count / 2, end_near);
    find_in(first + count / 2, count - count / 2, end_near);
  } else {
    std::array<bool, kFewPlaces> covered{};
    for (std::size_t n = end_near; n < near_.size(); ++n)
      for (std::size_t i = 0; i < count; ++i) covered[i] |= distance2(near_[n], places_[first + i]) < spacing2_;
    for (std::size_t i = 0; i < count; ++i)
      if (!covered[i]) uncovered_.push_back(static_cast<std::uint32_t>(first + i));
  }
  near_.resize(end_near);
}

}  // namespace pointsweep
