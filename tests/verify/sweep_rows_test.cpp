// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "pointsweep/reader.h"
#include "pointsweep/verify/rows/row_alignment.h"
#include "pointsweep/writer.h"
#include "tests/pipeline/hostile_clouds.h"

namespace pointsweep {
namespace {

TEST(SweepRows, ArePlacesInTheSortedCloud) {
  for (const auto& [name, shape] : hostile_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, 3000, 9);
    std::vector<double> xyz;
    for (const Vec3& p : points) xyz.insert(xyz.end(), {p.x, p.y, p.z});
    ArrayReader reader{std::span<const double>(xyz)};
    RowSource source(reader);
    std::vector<std::uint64_t> chosen;
    for (std::uint64_t row = 0; row < points.size(); row += 7) chosen.push_back(row);
    for (const int axis : {0, 1, 2}) {
      std::vector<std::uint64_t> sorted(points.size());
      std::iota(sorted.begin(), sorted.end(), std::uint64_t{0});
      const auto key = [&](std::uint64_t row) {
        const Vec3 p = points[row];
        return is_finite(p) ? std::tuple(0, p[axis], p.x, p.y, p.z, row) : std::tuple(1, 0.0, 0.0, 0.0, 0.0, row);
      };
      std::sort(sorted.begin(), sorted.end(), [&](std::uint64_t a, std::uint64_t b) { return key(a) < key(b); });
      const auto places = sweep_rows(source, chosen, axis, {});
      for (std::size_t i = 0; i < chosen.size(); ++i) ASSERT_EQ(sorted[places[i]], chosen[i]) << name << " " << axis;
    }
  }
}

}  // namespace
}  // namespace pointsweep
