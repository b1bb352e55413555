// SPDX-License-Identifier: MIT
/// The stage voxel(keep=centroid) against a map of voxels.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>

#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

__extension__ typedef __float128 Quad;

/// Returns the fields of `input`, those of with_attributes(), and nx, ny, nz as f32.
Records with_normals(const Records& input, std::uint64_t seed) {
  Records out{input.schema, {}};
  for (const char* name : {"nx", "ny", "nz"}) out.schema.append(name, Type::f32);
  std::mt19937_64 random(seed);
  for (std::size_t i = 0; i < input.size(); ++i) {
    out.bytes.insert(out.bytes.end(), input.at(i), input.at(i) + input.schema.stride);
    // Opposite directions are frequent, so that some voxels cancel.
    const float sign = random() % 2 == 0 ? 1.0F : -1.0F;
    const std::array<float, 3> n =
        random() % 3 == 0 ? std::array{0.6F * sign, 0.0F, 0.8F * sign} : std::array{0.0F, sign, 0.0F};
    const auto* bytes = reinterpret_cast<const std::byte*>(n.data());
    out.bytes.insert(out.bytes.end(), bytes, bytes + sizeof n);
  }
  return out;
}

/// Returns the mean of the finite values: their sum in 113 bits, rounded once, divided by their number.
double mean_of(const std::vector<double>& values) {
  Quad sum = 0;
  double n = 0, least = 1e308, most = -1e308;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    sum += v, n += 1;
    least = std::min(least, v), most = std::max(most, v);
  }
  return n == 0 ? std::nan("") : std::clamp(static_cast<double>(sum) / n, least, most);
}

struct Centroids {
  std::vector<std::size_t> rows;  ///< rows that stay, ascending
  std::map<std::size_t, std::vector<std::size_t>> members;
};

Centroids voxels_by_map(const Records& input, double size) {
  std::map<std::array<double, 3>, std::vector<std::size_t>> voxels;
  Centroids all;
  for (std::size_t i = 0; i < input.size(); ++i) {
    const Vec3 p = input.position(i);
    if (!is_finite(p)) {
      all.rows.push_back(i);
      continue;
    }
    voxels[{std::floor(p.x / size), std::floor(p.y / size), std::floor(p.z / size)}].push_back(i);
  }
  for (const auto& [voxel, members] : voxels) {
    const Vec3 center{(voxel[0] + 0.5) * size, (voxel[1] + 0.5) * size, (voxel[2] + 0.5) * size};
    const auto key = [&](std::size_t i) {
      const Vec3 p = input.position(i);
      return std::tuple(distance2(p, center), p.x, p.y, p.z, i);
    };
    const std::size_t best =
        *std::min_element(members.begin(), members.end(), [&](auto a, auto b) { return key(a) < key(b); });
    all.rows.push_back(best);
    all.members[best] = members;
  }
  std::sort(all.rows.begin(), all.rows.end());
  return all;
}

void expect_centroids(const Records& input, const RunResult& got, double size) {
  const Centroids expected = voxels_by_map(input, size);
  ASSERT_EQ(got.statistics.points_written, expected.rows.size());
  const Records out = records_of(got);
  for (std::size_t o = 0; o < expected.rows.size(); ++o) {
    const std::size_t row = expected.rows[o];
    SCOPED_TRACE(fmt::format("row {} of the output, {} of the input", o, row));
    for (const char* label : {"classification", "id"}) ASSERT_EQ(out.value(o, label), input.value(row, label)) << label;
    if (!expected.members.contains(row)) continue;
    const auto values = [&](const char* field) {
      std::vector<double> all;
      for (const std::size_t i : expected.members.at(row)) all.push_back(input.value(i, field));
      return all;
    };
    for (const char* axis : {"x", "y", "z"}) ASSERT_EQ(out.value(o, axis), mean_of(values(axis))) << axis;
    ASSERT_EQ(out.value(o, "intensity"), std::nearbyint(mean_of(values("intensity"))));
    const double gain = mean_of(values("gain"));
    ASSERT_TRUE(std::isnan(gain) ? std::isnan(out.value(o, "gain")) : out.value(o, "gain") == static_cast<float>(gain));
    const Vec3 n{mean_of(values("nx")), mean_of(values("ny")), mean_of(values("nz"))};
    const double size_of_mean = length(n);
    const Vec3 made{out.value(o, "nx"), out.value(o, "ny"), out.value(o, "nz")};
    if (size_of_mean == 0)
      ASSERT_EQ(made, Vec3{});
    else
      ASSERT_LT(length(made - (1 / size_of_mean) * n), 1e-6);
  }
}

TEST(VoxelCentroid, IsTheMeanOfThePointsOfAVoxel) {
  for (const auto& [name, shape] : hostile_shapes()) {
    const Records input = with_normals(with_attributes(make_cloud(shape, sized(900), 3)), 4);
    for (const double size : {0.3, 1e-7, 1e4}) {
      SCOPED_TRACE(fmt::format("{}, {}", name, size));
      const std::string pipeline = fmt::format("voxel({}, keep=centroid)", size);
      const RunResult first = run_text(input, pipeline, tiny(300));
      expect_centroids(input, first, size);
      EXPECT_EQ(first.schema, input.schema) << "types stay, and nothing is added";
      for (EngineOptions options : {tiny(100, true, 2), tiny(50'000, false, 3)})
        for (int axis = 0; axis < 3; ++axis) {
          options.axis = axis;
          ASSERT_TRUE(run_text(input, pipeline, options).records == first.records) << axis;
        }
    }
  }
}

TEST(VoxelCentroid, DoesNotDependOnTheOrderOfRows) {
  const Records input = with_normals(with_attributes(make_cloud(hostile_shapes()[1].second, sized(900), 5)), 6);
  std::vector<std::size_t> order(input.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937_64(7));
  Records shuffled{input.schema, {}};
  for (const std::size_t i : order)
    shuffled.bytes.insert(shuffled.bytes.end(), input.at(i), input.at(i) + input.schema.stride);
  EngineOptions options = tiny(200);
  options.order = Order::sweep;
  EXPECT_TRUE(run_text(input, "voxel(0.2, keep=centroid)", options).records ==
              run_text(shuffled, "voxel(0.2, keep=centroid)", options).records);
}

TEST(VoxelCentroid, LaterStagesSeeTheMeansAsTheCloud) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[0].second, sized(1200), 8));
  const RunResult thin = run_text(input, "voxel(0.2, keep=centroid)", tiny(100));
  for (const EngineOptions& options : {tiny(100, false, 1), tiny(100, true, 2)}) {
    const RunResult got = run_text(input, "knn(k=6) | voxel(0.2, keep=centroid) | normals", options);
    const RunResult expected = run_text(records_of(thin), "knn(k=6) | normals", options);
    EXPECT_EQ(got.schema, expected.schema);
    EXPECT_TRUE(got.records == expected.records);
  }
}

TEST(VoxelCentroid, AveragesWhatIsMadeByItsKind) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[0].second, sized(800), 9));
  const std::string make = "knn(k=8) | normals | neighborhood_size | set(flag = 1 where x > 0, as=uint8)";
  const Records made = records_of(run_text(input, make, tiny(100)));
  expect_centroids(made, run_text(input, make + " | voxel(0.4, keep=centroid)", tiny(100, true, 2)), 0.4);
  const RunResult got = run_text(input, make + " | voxel(0.4, keep=centroid)", tiny(100));
  const Centroids expected = voxels_by_map(made, 0.4);
  const std::vector<double> flag = got.field("flag"), count = got.field("neighbor_count"),
                            radius = got.field("neighbor_radius");
  for (std::size_t o = 0; o < expected.rows.size(); ++o) {
    std::vector<double> radii;
    for (const std::size_t i : expected.members.at(expected.rows[o])) radii.push_back(made.value(i, "neighbor_radius"));
    ASSERT_EQ(flag[o], made.value(expected.rows[o], "flag"));
    ASSERT_EQ(count[o], made.value(expected.rows[o], "neighbor_count"));
    ASSERT_EQ(radius[o], mean_of(radii));
  }
}

TEST(VoxelCentroid, LargestIntegersStayWhatTheyAre) {
  Records input;
  for (const char* axis : {"x", "y", "z"}) input.schema.append(axis, Type::f64);
  input.schema.append("intensity", Type::u64);
  const std::uint64_t largest = std::numeric_limits<std::uint64_t>::max();
  input.bytes.resize(4 * input.schema.stride);
  for (std::size_t i = 0; i < 4; ++i) {
    const double x = 0.1 * static_cast<double>(i);
    std::memcpy(input.bytes.data() + i * input.schema.stride, &x, sizeof x);
    std::memcpy(input.bytes.data() + i * input.schema.stride + 3 * sizeof x, &largest, sizeof largest);
  }
  const Records got = records_of(run_text(input, "voxel(1, keep=centroid)", tiny(100)));
  ASSERT_EQ(got.size(), 1U);
  std::uint64_t mean = 0;
  std::memcpy(&mean, got.at(0) + got.schema.fields.at(*got.schema.find("intensity")).offset, sizeof mean);
  EXPECT_EQ(mean, largest);
}

}  // namespace
}  // namespace pointsweep
