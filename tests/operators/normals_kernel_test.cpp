// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "pointsweep/operator.h"
#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/points/degenerate_points.h"
#include "tests/operators/equation1.h"
#include "tests/operators/mixed_cloud.h"
#include "tests/support/brute_force.h"
#include "tests/support/in_core.h"
#include "tests/support/instruction_sets.h"

namespace pointsweep {
namespace {

using Normal = std::array<float, 3>;

class Unoriented : public LocalOperator {
 public:
  std::string name() const override { return "unoriented"; }
  Contract contract() const override { return {{}, {}, {normal_attribute()}}; }
  void apply(const Neighborhoods& in, Columns& out) const override {
    unoriented_normals(in, out.column<Normal>(0), out.degenerate());
  }
};

TEST(NormalsKernel, HasTheBitsOfItsScalarTwinOnEveryInstructionSet) {
  const MixedCloud cloud(20053);
  for_each_instruction_set([&] {
    const auto found = InCoreCloud(cloud.points, cloud.lists).apply(Unoriented()).column<Normal>(0);
    std::size_t planes = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const Normal twin = scalar_normal(cloud.points, i, cloud.lists[i]);
      ASSERT_EQ(std::memcmp(&found[i], &twin, sizeof twin), 0) << i;
      planes += twin != Normal{};
    }
    EXPECT_GT(planes, found.size() / 2);
    EXPECT_LT(planes, found.size());
  });
}

TEST(NormalsKernel, DoesNotCareWhichPointsShareABatch) {
  const MixedCloud cloud(20053);
  const auto whole = InCoreCloud(cloud.points, cloud.lists).apply(Unoriented()).columns[0];
  for (const std::size_t cell_points : {1u, 2u, 3u, 7u, 15u, 17u, 100u})
    EXPECT_EQ(InCoreCloud(cloud.points, cloud.lists, cell_points).apply(Unoriented()).columns[0], whole) << cell_points;
}

}  // namespace
}  // namespace pointsweep
