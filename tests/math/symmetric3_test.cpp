// SPDX-License-Identifier: MIT
#include "pointsweep/math/symmetric3.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstring>
#include <random>
#include <span>
#include <vector>

#include "pointsweep/math/batch.h"
#include "tests/support/instruction_sets.h"

namespace pointsweep {
namespace {

constexpr double kEpsilon = 0x1p-52;

/// Returns matrices with eigenvalues of very different sizes, equal, zero or negative eigenvalues, and entries from a
/// list of special values.
std::vector<Symmetric3> matrices() {
  std::vector<Symmetric3> all{{}, {1, 0, 0, 1, 0, 1}, {3, 0, 0, 2, 0, 1}, {0, 1, 0, 0, 0, 0}, {1, 1, 1, 1, 1, 1}};
  std::mt19937_64 random(20052);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(-15, 0);
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Matrix3d q = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                                  .normalized()
                                  .toRotationMatrix();
    const double a = std::pow(10, exponent(random)), b = i % 3 == 0 ? a : std::pow(10, exponent(random));
    const Eigen::Matrix3d m = q * Eigen::Vector3d(i % 5 ? 1 : -1, a, i % 7 ? b : 0).asDiagonal() * q.transpose();
    all.push_back({m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)});
  }
  const double special[] = {0, 1, -1, 1e-8, 0.5, 1e-16, 1e-200};
  for (int code = 0; code < 117649; code += 3) {
    double entry[6];
    for (int e = 0, rest = code; e < 6; ++e, rest /= 7) entry[e] = special[rest % 7];
    all.push_back({entry[0], entry[1], entry[2], entry[3], entry[4], entry[5]});
  }
  return all;
}

Vec3 times(const Symmetric3& m, Vec3 v) {
  return {dot({m.xx, m.xy, m.xz}, v), dot({m.xy, m.yy, m.yz}, v), dot({m.xz, m.yz, m.zz}, v)};
}

double largest_entry(const Symmetric3& m) {
  return std::max({std::abs(m.xx), std::abs(m.xy), std::abs(m.xz), std::abs(m.yy), std::abs(m.yz), std::abs(m.zz)});
}

TEST(EigenSymmetric3, GivesOrthonormalEigenvectorsAndAscendingValues) {
  for (const Symmetric3& m : matrices()) {
    const Eigen3 e = eigen_symmetric3(m);
    EXPECT_LE(e.value[0], e.value[1]);
    EXPECT_LE(e.value[1], e.value[2]);
    for (int i = 0; i < 3; ++i) {
      ASSERT_NEAR(length(e.vector[i]), 1, 8 * kEpsilon);
      ASSERT_NEAR(dot(e.vector[i], e.vector[(i + 1) % 3]), 0, 8 * kEpsilon);
      ASSERT_LE(length(times(m, e.vector[i]) - e.value[i] * e.vector[i]), 30 * kEpsilon * largest_entry(m));
    }
  }
}

TEST(EigenSymmetric3, AgreesWithEigenToRoundingOverTheGap) {
  for (const Symmetric3& m : matrices()) {
    Eigen::Matrix<long double, 3, 3> a;
    a << m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<long double, 3, 3>> truth(a);
    const Eigen3 e = eigen_symmetric3(m);
    const double size = largest_entry(m);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(e.value[i], double(truth.eigenvalues()(i)), 20 * kEpsilon * size);
    const double gap = double(truth.eigenvalues()(1) - truth.eigenvalues()(0));
    if (gap < 1e-12 * size || size == 0) continue;
    const Vec3 t{double(truth.eigenvectors()(0, 0)), double(truth.eigenvectors()(1, 0)),
                 double(truth.eigenvectors()(2, 0))};
    EXPECT_LE(length(cross(t, e.vector[0])), 30 * kEpsilon * size / gap);
  }
}

TEST(EigenSymmetric3, FollowsAScalingByPowersOfTwoExactly) {
  const Symmetric3 m{1.25, 0.3, -0.7, 2.5, 0.11, 0.4};
  const Eigen3 e = eigen_symmetric3(m);
  for (const double s : {0x1p-900, 0x1p-40, 0x1p40, 0x1p900}) {
    const Eigen3 scaled = eigen_symmetric3({s * m.xx, s * m.xy, s * m.xz, s * m.yy, s * m.yz, s * m.zz});
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(scaled.vector[i], e.vector[i]);
      EXPECT_EQ(scaled.value[i], s * e.value[i]);
    }
  }
}

TEST(EigenSymmetric3, HasTheSameBitsInEveryLaneOfEveryInstructionSet) {
  const std::vector<Symmetric3> all = matrices();
  for_each_instruction_set([&] {
    for (const std::size_t first : {0u, 1u, 5u}) {  // each matrix in other lanes, beside other matrices
      const std::span<const Symmetric3> some = std::span(all).subspan(first);
      std::vector<Eigen3> found(some.size());
      batch_eigen_symmetric3(some, found);
      for (std::size_t i = 0; i < some.size(); ++i) {
        const Eigen3 twin = eigen_symmetric3(some[i]);
        ASSERT_EQ(std::memcmp(&found[i], &twin, sizeof twin), 0) << i;
      }
    }
  });
}

}  // namespace
}  // namespace pointsweep
