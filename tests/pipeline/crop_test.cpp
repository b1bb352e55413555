// SPDX-License-Identifier: MIT
/// The operator crop keeps the points that a plain loop finds inside.
#include <gtest/gtest.h>

#include "pointsweep/operators.h"
#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/formats/temporary_folder.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

using IsInside = bool (*)(Vec3);

/// Returns regions whose edges lie on multiples of 1/8, as options and as functions.
const std::vector<std::pair<std::string, IsInside>>& regions() {
  static const std::vector<std::pair<std::string, IsInside>> all = {
      {"[-0.5,0.125,0.0,0.75,4,4]",
       [](Vec3 p) { return p.x >= -0.5 && p.x <= 0.75 && p.y >= 0.125 && p.y <= 4 && p.z >= 0 && p.z <= 4; }},
      {"bounds=[0,0,7,6]", [](Vec3 p) { return p.x >= 0 && p.x <= 7 && p.y >= 0 && p.y <= 6; }},
      {"polygon=\"POLYGON ((0 0, 8 0, 0 8, 0 0))\"", [](Vec3 p) { return p.x >= 0 && p.y >= 0 && p.x + p.y <= 8; }},
      {"polygon=\"MULTIPOLYGON (((-1 -1, 9 -1, 9 9, -1 9, -1 -1), (1 1, 1 4, 4 4, 4 1, 1 1)), ((0 0, 2 0, 2 2, 0 2, 0 "
       "0)))\"",
       [](Vec3 p) {
         const bool square = p.x >= -1 && p.x <= 9 && p.y >= -1 && p.y <= 9;
         const bool hole = p.x > 1 && p.x < 4 && p.y > 1 && p.y < 4;
         return (square && !hole) || (p.x >= 0 && p.x <= 2 && p.y >= 0 && p.y <= 2);
       }},
      {"bounds=[0,-9,9,9], polygon='POLYGON ((-3 -3, 3 -3, 3 3, -3 3, -3 -3))'",
       [](Vec3 p) { return p.x >= 0 && p.x <= 3 && p.y >= -3 && p.y <= 3; }}};
  return all;
}

TEST(Crop, LeavesTheCloudOfThePointsInsideForAllLaterStages) {
  std::size_t turn = 0;
  for (const auto& [name, shape] : hostile_shapes()) {
    const Records input = with_attributes(make_cloud(shape, sized(700), 3));
    for (const bool outside : {false, true}) {
      const auto& [region, is_inside] = regions()[turn++ % regions().size()];
      SCOPED_TRACE(name + ", " + region);
      const Records kept = input.those([&, &f = is_inside](std::size_t i) { return f(input.position(i)) != outside; });
      const std::string crop = "crop(" + region + (outside ? ", outside=true)" : ")");
      for (const Order order : {Order::input, Order::sweep}) {
        for (EngineOptions options : {tiny(100, false, 1), tiny(100, true, 2), tiny(50'000, false, 3)}) {
          options.order = order;
          const RunResult got = run_text(input, "knn(k=6) | " + crop + " | normals", options);
          ASSERT_EQ(got.statistics.points_written, kept.size());
          if (kept.size() == 0) continue;
          const RunResult expected = run_text(kept, "knn(k=6) | normals", options);
          ASSERT_EQ(got.schema, expected.schema);
          ASSERT_TRUE(got.records == expected.records);
        }
      }
      const RunResult alone = run_text(input, crop, tiny(1000));
      EXPECT_TRUE(alone.records == kept.bytes);
      EXPECT_EQ(alone.statistics.sweeps, 0u);
    }
  }
}

TEST(Crop, PointsOnFacesEdgesAndCornersAreInside) {
  std::vector<Vec3> points;
  for (int x = -1; x <= 9; ++x)
    for (int y = -1; y <= 9; ++y)
      for (int z = -1; z <= 5; z += 2) points.push_back({double(x), double(y), double(z)});
  const Records input = with_attributes(points);
  for (const auto& [region, is_inside] : regions())
    for (const bool outside : {false, true}) {
      const Records kept = input.those([&, &f = is_inside](std::size_t i) { return f(points[i]) != outside; });
      EXPECT_TRUE(run_text(input, "crop(" + region + (outside ? ", outside=true)" : ")"), tiny(100)).records ==
                  kept.bytes)
          << region;
    }
}

TEST(Crop, PointsWithoutAPlaceAreNotInside) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN(), kFar = std::numeric_limits<double>::infinity();
  const Records input = with_attributes({{kNone, 1, 1}, {1, 1, kNone}, {1, kFar, 1}, {1, 1, -kFar}, {1, 1, 1}});
  const auto left = [&](const std::string& pipeline) {
    return run_text(input, pipeline, tiny(100)).statistics.points_written;
  };
  EXPECT_EQ(left("crop([0,0,9,9])"), 3u);
  EXPECT_EQ(left("crop([0,0,0,9,9,9])"), 1u);
  EXPECT_EQ(left("crop(polygon='POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0))')"), 3u);
  EXPECT_EQ(left("crop([0,0,0,9,9,9], outside=true)"), 4u);
}

TEST(Crop, IsTheSameStageInJson) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[1].second, 500, 4));
  const auto records = [&](const std::string& pipeline) { return run_text(input, pipeline, tiny(100)).records; };
  const std::string box = R"json([{"type": "crop", "bounds": [0.25, 0, 0.75, 0.5], "outside": true}])json";
  EXPECT_EQ(records(box), records("crop([0.25,0,0.75,0.5], outside=true)"));
  const std::string area = R"json([{"type": "crop", "polygon": "POLYGON ((0 0, 0.5 0, 0.5 0.5, 0 0))"}])json";
  EXPECT_EQ(records(area), records("crop(polygon='POLYGON ((0 0, 0.5 0, 0.5 0.5, 0 0))')"));
}

TEST(Crop, ItsRecordHasTheChecksumOfTheFile) {
  const TemporaryFolder folder;
  const std::string path = (folder / "area.wkt").string(), text = "POLYGON ((0 0, 10 0, 10 10, 0 0))";
  folder.write("area.wkt", text);
  const auto checksum = [&] { return options_of(operators::crop({.polygon = path})).back(); };
  EXPECT_EQ(checksum(), (Option{"checksum", "baf74575be7585e0"}));
  EXPECT_NO_THROW(operators::crop({.polygon = path, .checksum = "baf74575be7585e0"}));
  folder.write("area.wkt", text + " ");
  EXPECT_NE(checksum(), (Option{"checksum", "baf74575be7585e0"}));
  try {
    operators::crop({.polygon = path, .checksum = "baf74575be7585e0"});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("their checksum is"), std::string::npos) << error.what();
  }
  EXPECT_THROW(operators::crop({.polygon = (folder / "none.wkt").string()}), Error);
}

TEST(Crop, TellsWhatIsWrong) {
  const Records input = with_attributes({{0, 0, 0}, {1, 1, 1}});
  const auto expect = [&](const std::string& text, const std::string& words) {
    const std::string sentence = refusal([&] { run_text(input, text, tiny(100)); });
    EXPECT_NE(sentence.find(words), std::string::npos) << text << "\n" << sentence;
  };
  expect("crop", "column 1: crop: nothing says what is inside; give bounds=[XMIN,YMIN,XMAX,YMAX] or polygon=FILE");
  expect("crop([0,1,2])", "bounds are 4 numbers");
  expect("crop([0,1,2,3,4])", "or 6 with ZMIN and ZMAX, not 5");
  expect("crop([0,1,2,0.5])", "of the bounds the least y is 1, more than the most, 0.5");
  expect("crop([0,1,2,x])", "bounds is a list of numbers, [A,B,...], not '0,1,2,x'");
  expect("crop([0,1,2,inf])", "bounds is a list of numbers");
  expect("crop([0,0,1,1], outside=yes)", "outside is false or true, not 'yes'");
  expect("crop([0,0,1,1], checksum=ab)", "give polygon=FILE");
}

}  // namespace
}  // namespace pointsweep
