// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <random>

#include "pointsweep/geometry.h"
#include "pointsweep/operators/nearest/place_group.h"

namespace pointsweep {
namespace {

double number(std::mt19937_64& random) { return 1 + static_cast<double>(random() >> 11) * 0x1p-53; }

/// The place is the origin. The points have the coordinates of the nearest point in another order, so they are equally
/// far away, and rounding makes some of them nearer.
TEST(NearestBound, LeavesOutNothingThatRoundingMakesAsNear) {
  std::mt19937_64 random(1);
  int nearer = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 near{number(random), number(random), number(random)};
    const NearestBound bound({{}, {}}, {near, near}, 100);
    for (const Vec3 p : {Vec3{near.y, near.z, near.x}, Vec3{near.z, near.y, near.x}}) {
      ASSERT_FALSE(bound.out(p)) << i;
      ASSERT_FALSE(bound.out(Box{p, p})) << i;
      nearer += distance2(p, {}) < distance2(near, {});
    }
  }
  EXPECT_GT(nearer, 1000);
}

/// The points are farther by 2^-44 of the distance. The places are near to each other and far from the origin.
TEST(NearestBound, LeavesOutWhatIsALittleFarther) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 place{1e9 * number(random), 1e9 * number(random), -1e9 * number(random)};
    const Box places{place, place + Vec3{1e-3, 1e-3, 1e-3}};
    const Vec3 farther = (1 + 0x1p-44) * place;
    const NearestBound bound(places, {2 * place, 2 * place}, 1e30);
    EXPECT_FALSE(bound.out(2 * place));
    EXPECT_TRUE(bound.out(place + farther)) << i;
    EXPECT_TRUE(bound.out(Box{place + farther, place + farther})) << i;
  }
}

}  // namespace
}  // namespace pointsweep
