// SPDX-License-Identifier: MIT
#include "pointsweep/operators/normals_kernel.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "pointsweep/operator.h"
#include "pointsweep/points/degenerate_points.h"
#include "tests/operators/equation1.h"
#include "tests/support/brute_force.h"
#include "tests/support/in_core.h"
#include "tests/support/instruction_sets.h"

namespace pointsweep {
namespace {

using Normal = std::array<float, 3>;

class Unoriented : public Operator {
 public:
  std::string name() const override { return "unoriented"; }
  Contract contract() const override { return {{}, {}, {normal_attribute()}}; }
  void apply(const Neighborhoods& in, Columns& out) const override {
    unoriented_normals(in, out.column<Normal>(0), out.degenerate());
  }
};

/// A crowd of every kind: volume, plane, line, duplicates, neighbourhoods of 0 to 1000 points, in one batch.
struct Crowd {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> lists;

  Crowd() {
    std::mt19937_64 random(20053);
    std::uniform_real_distribution<double> u(-1, 1);
    for (int i = 0; i < 1300; ++i) {
      const Vec3 p{u(random), u(random), u(random)};
      points.push_back(i % 5 == 0   ? Vec3{p.x, p.y, 0.25}
                       : i % 5 == 1 ? Vec3{p.x, 2 * p.x, 3 * p.x}
                       : i % 5 == 2 ? Vec3{std::round(3 * p.x), std::round(3 * p.y), 0}
                                    : 1e-7 * p + Vec3{1000, 2000, 3000});
    }
    const std::size_t counts[] = {8, 8, 0, 1, 2, 3, 8, 9, 7, 17, 64, 8, 1000, 16, 33};
    for (std::uint32_t i = 0; i < points.size(); ++i)
      lists.push_back(brute_force_neighbors_of(points, i, counts[i % std::size(counts)], 1e9));
  }
};

TEST(NormalsKernel, HasTheBitsOfItsScalarTwinOnEveryInstructionSet) {
  const Crowd crowd;
  for_each_instruction_set([&] {
    const auto found = InCoreCloud(crowd.points, crowd.lists).apply(Unoriented()).column<Normal>(0);
    std::size_t planes = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const Normal twin = scalar_normal(crowd.points, i, crowd.lists[i]);
      ASSERT_EQ(std::memcmp(&found[i], &twin, sizeof twin), 0) << i;
      planes += twin != Normal{};
    }
    EXPECT_GT(planes, found.size() / 2);
    EXPECT_LT(planes, found.size());
  });
}

TEST(NormalsKernel, DoesNotCareWhichPointsShareABatch) {
  const Crowd crowd;
  const auto whole = InCoreCloud(crowd.points, crowd.lists).apply(Unoriented()).columns[0];
  for (const std::size_t cell_points : {1u, 2u, 3u, 7u, 15u, 17u, 100u})
    EXPECT_EQ(InCoreCloud(crowd.points, crowd.lists, cell_points).apply(Unoriented()).columns[0], whole) << cell_points;
}

}  // namespace
}  // namespace pointsweep
