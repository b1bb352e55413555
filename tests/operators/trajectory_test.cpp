// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "pointsweep/error.h"
#include "pointsweep/operators/surface/facing_normals.h"

namespace pointsweep {
namespace {

TEST(Trajectory, LiesOnStraightLinesBetweenItsPlaces) {
  const Trajectory t("10 1 2 3\n14 5 2 -1\n12 1 4 3\n", "t");
  EXPECT_EQ(t.at(10), (Vec3{1, 2, 3}));
  EXPECT_EQ(t.at(11), (Vec3{1, 3, 3}));
  EXPECT_EQ(t.at(12), (Vec3{1, 4, 3}));
  EXPECT_EQ(t.at(13.5), (Vec3{4, 2.5, 0}));
  EXPECT_EQ(t.at(9), (Vec3{1, 2, 3}));
  EXPECT_EQ(t.at(15), (Vec3{5, 2, -1}));
  EXPECT_EQ(t.first_time(), 10);
  EXPECT_EQ(t.last_time(), 14);
}

TEST(Trajectory, IsReadWithAnySeparatorNamesCommentsAndFurtherColumns) {
  for (const char* text : {"gps_time,x,y,z,roll\n1,2,3,4,0.5\r\n\r\n2,3,4,5,x\n", "# a flight\n1;2;3;4\n\n2;3;4;5",
                           "1\t2\t3\t4\n 2\t3\t4\t5\n", "time x y z\n1 2  3 4\n2 3 4 5\n"}) {
    const Trajectory t(text, "t");
    EXPECT_EQ(t.at(1.5), (Vec3{2.5, 3.5, 4.5})) << text;
  }
}

TEST(Trajectory, SaysWhichLineIsWrong) {
  const auto error_of = [](const char* text) -> std::string {
    try {
      Trajectory(text, "flight.csv");
      return "none";
    } catch (const Error& error) {
      return error.what();
    }
  };
  EXPECT_TRUE(error_of("1 2 3 4\n2 3 4\n").starts_with("flight.csv, line 2: "));
  EXPECT_TRUE(error_of("a b c d\ne f g h\n").starts_with("flight.csv, line 2: "));
  EXPECT_TRUE(error_of("1 2 3 nan\n1 2 3 inf\n").starts_with("flight.csv, line 2: "));
  EXPECT_TRUE(error_of("").starts_with("flight.csv: holds no time"));
  EXPECT_TRUE(error_of("1 2 3 4\n1 2 3 5\n").starts_with("flight.csv: has the time 1 twice"));
}

}  // namespace
}  // namespace pointsweep
