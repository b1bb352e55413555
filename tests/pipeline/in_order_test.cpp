// SPDX-License-Identifier: MIT
#include <cmath>
#include <limits>

#include "pointsweep/in_order_operator.h"
#include "tests/pipeline/moving_clouds.h"

namespace pointsweep {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();

/// An operator that drops points with x < -1 and sets the values of points with x > 1. Other points get the fill.
class Sides final : public InOrderOperator {
 public:
  std::string name() const override { return "sides"; }
  InOrderContract in_order_contract() const override {
    Attribute side = scalar("side", Type::u8, "1", "7: between"), twice = scalar("twice", Type::f64, "1", "2 x");
    side.fill = std::byte{7}, twice.fill = std::byte{0xff};
    return {.makes = {side, twice}, .drops_rows = true};
  }
  std::unique_ptr<InOrderWork> start(const InOrderSetup&) const override {
    class Work final : public InOrderWork {
      void add(unsigned, const OrderedPoints& points, Findings& findings) override {
        for (std::size_t i = 0; i < points.rows.size(); ++i) {
          const double x = points.positions[i].x;
          if (x < -1) findings.dropped.push_back(points.rows[i]);
          if (x <= 1) continue;
          findings.rows.push_back(points.rows[i]);
          findings.values.push_back(std::byte{1});
          const double twice = 2 * x;
          const auto bytes = std::as_bytes(std::span(&twice, 1));
          findings.values.insert(findings.values.end(), bytes.begin(), bytes.end());
        }
      }
    };
    return std::make_unique<Work>();
  }
};

std::vector<Vec3> line_of_points() {
  std::vector<Vec3> points;
  for (int i = 0; i < 900; ++i) points.push_back({(i * 7 % 900 - 450) / 100.0, 0, 0});
  points[13] = {kNowhere, 0, 0};
  return points;
}

TEST(InOrder, AnOperatorDropsRowsAndMakesAttributesThatHaveEachTheirOwnFill) {
  const std::vector<Vec3> points = line_of_points();
  for (const bool spill : {false, true}) {
    const RunResult got = run_in_memory(points, {{}, {std::make_shared<Sides>()}}, tiny(100, spill));
    const std::vector<double> x = got.field("x"), side = got.field("side"), twice = got.field("twice");
    std::size_t next = 0;
    for (const Vec3& p : points) {
      if (p.x < -1) continue;
      ASSERT_LT(next, x.size());
      ASSERT_TRUE(x[next] == p.x || (std::isnan(p.x) && std::isnan(x[next])));
      ASSERT_EQ(side[next], p.x > 1 ? 1 : 7) << p.x;
      ASSERT_TRUE(p.x > 1 ? twice[next] == 2 * p.x : std::isnan(twice[next])) << p.x;
      ++next;
    }
    EXPECT_EQ(next, x.size());
  }
}

TEST(InOrder, WhatIsKeptInPartHasItsValuesAndFills) {
  const std::vector<Vec3> points = line_of_points();
  Chain chain{{}, {std::make_shared<Sides>()}};
  const RunResult all = run_in_memory(points, chain, tiny(100));
  for (const char* name : {"side", "twice"}) {
    chain.keep = {name};
    const std::vector<double> part = run_in_memory(points, chain, tiny(100)).field(name), whole = all.field(name);
    ASSERT_EQ(part.size(), whole.size());
    for (std::size_t i = 0; i < part.size(); ++i)
      ASSERT_TRUE(part[i] == whole[i] || (std::isnan(part[i]) && std::isnan(whole[i]))) << name << " of " << i;
  }
}

TEST(InOrder, LaterStagesSeeTheRowsThatAreLeftWithTheirValues) {
  const std::vector<Vec3> points = line_of_points();
  const RunResult got =
      run_in_memory(points, {{}, {std::make_shared<Sides>(), operators::where("side == 1")}}, tiny(100));
  const auto right = std::ranges::count_if(points, [](const Vec3& p) { return p.x > 1; });
  EXPECT_EQ(got.field("twice").size(), static_cast<std::size_t>(right));
  for (const double twice : got.field("twice")) EXPECT_GT(twice, 2);
}

}  // namespace
}  // namespace pointsweep
