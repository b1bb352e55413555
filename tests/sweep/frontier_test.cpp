// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/frontier.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace pointsweep {
namespace {

Box random_box(std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  Box box;
  const Vec3 corner{10 * uniform(random), uniform(random), uniform(random)};
  box.include(corner);
  box.include(corner + Vec3{uniform(random) * uniform(random), uniform(random), uniform(random)});
  return box;
}

Slab slab_at(Vec3 place, std::uint64_t least_row) { return {0, 100, {place, place}, least_row}; }

TEST(Frontier, FindsUnreadSlabsInWhateverOrderTheyCome) {
  std::mt19937_64 random(1);
  std::vector<Slab> slabs(40);
  for (Slab& slab : slabs) slab.box = random_box(random);
  Frontier frontier(slabs, 0);
  for (std::size_t read = 0; read <= slabs.size(); ++read) {
    for (int i = 0; i < 50; ++i) {
      const Box box = random_box(random);
      const double reach2 = std::uniform_real_distribution<double>(0, 4)(random);
      const bool expected = std::any_of(slabs.begin() + static_cast<std::ptrdiff_t>(read), slabs.end(),
                                        [&](const Slab& slab) { return distance2(slab.box, box) <= reach2; });
      ASSERT_EQ(frontier.unread_within(box, reach2), expected);
      ASSERT_EQ(frontier.anything_unread_within(box, reach2), expected);
    }
    if (read < slabs.size()) frontier.slab_was_read();
  }
}

TEST(Frontier, TellsSlabsThatTheSweepReadsFromThoseOfTheRecall) {
  std::mt19937_64 random(2);
  std::vector<Slab> slabs(40);
  for (Slab& slab : slabs) slab.box = random_box(random);
  constexpr std::size_t kSwept = 25;
  Frontier frontier(slabs, 0, kSwept);
  std::size_t only_recall = 0;
  for (std::size_t read = 0; read <= kSwept; ++read) {
    for (int i = 0; i < 50; ++i) {
      const Box box = random_box(random);
      const double reach2 = std::uniform_real_distribution<double>(0, 1)(random);
      const auto near = [&](std::size_t first, std::size_t end) {
        return std::any_of(slabs.begin() + static_cast<std::ptrdiff_t>(first),
                           slabs.begin() + static_cast<std::ptrdiff_t>(end),
                           [&](const Slab& slab) { return distance2(slab.box, box) <= reach2; });
      };
      ASSERT_EQ(frontier.still_read_within(box, reach2), near(read, kSwept));
      ASSERT_EQ(frontier.only_recalled_within(box, reach2), near(kSwept, slabs.size()));
      ASSERT_EQ(frontier.unread_within(box, reach2), near(read, slabs.size()));
      only_recall += near(kSwept, slabs.size()) && !near(read, kSwept) ? 1 : 0;
    }
    if (read < kSwept) frontier.slab_was_read();
  }
  EXPECT_GT(only_recall, 10u);
}

TEST(Frontier, FurtherCopiesAtASaturatedLocationDoNotCount) {
  const Vec3 here{1, 2, 3}, there{1, 2, 4};
  const std::vector<Slab> slabs{slab_at(here, 0), slab_at(here, 5000), slab_at(there, 5000)};
  Frontier frontier(slabs, 0);
  frontier.slab_was_read();
  EXPECT_TRUE(frontier.unread_within(here, 0));
  frontier.location_is_saturated(here, 4999);
  EXPECT_FALSE(frontier.unread_within(here, 0));
  EXPECT_TRUE(frontier.anything_unread_within({here, here}, 0)) << "they look at what fills the place";
  EXPECT_TRUE(frontier.unread_within(here, 1)) << "the other place";
  EXPECT_TRUE(frontier.unread_within(there, 0));
}

TEST(Frontier, APlaceIsFullByItsLowestRows) {
  const Vec3 here{1, 2, 3};
  const std::vector<Slab> none;
  Frontier frontier(none, 0);
  frontier.location_is_saturated(here, 30);
  frontier.location_is_saturated(here, 10);
  frontier.location_is_saturated(here, 20);
  EXPECT_TRUE(frontier.is_superfluous({here, here}, 11));
  EXPECT_FALSE(frontier.is_superfluous({here, here}, 10));
  EXPECT_FALSE(frontier.is_superfluous({here, {1, 2, 4}}, 11)) << "more than one place";
}

}  // namespace
}  // namespace pointsweep
