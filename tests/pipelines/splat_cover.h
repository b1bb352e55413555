// SPDX-License-Identifier: MIT
/// Tests whether splats cover a surface without holes, by counting the splats over many points of the surface.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/pipeline/in_memory.h"

namespace pointsweep {

/// The splats that a pipeline makes, stored in a grid, so that few splats are tried for a point.
///
/// A splat lies over x if x, projected along the splat's normal into its plane, is inside its ellipse, and x is no
/// farther from that plane than `kHeight` major semi-axes: a splat of another sheet covers nothing.
class SplatCover {
 public:
  static constexpr double kHeight = 0.25;

  SplatCover(const std::vector<Vec3>& points, const std::string& pipeline) {
    const RunResult made = run_in_memory(points, build_chain(parse_pipeline(pipeline), Facts{}), {});
    const auto column = [&](const char* name) { return made.field(name); };
    const auto nx = column("nx"), ny = column("ny"), nz = column("nz"), ax = column("splat_x"), ay = column("splat_y"),
               az = column("splat_z"), length = column("splat_length"), ratio = column("splat_ratio");
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!(length[i] > 0)) continue;
      const Vec3 n{nx[i], ny[i], nz[i]}, axis{ax[i], ay[i], az[i]};
      splats_.push_back({points[i], n, axis, cross(n, axis), length[i], length[i] * ratio[i]});
    }
    fill_grid();
  }

  /// Returns the number of splats that lie over x.
  std::size_t over(Vec3 x) const {
    std::size_t count = 0;
    const auto here = grid_.find(key(cell_of(x)));
    if (here == grid_.end()) return 0;
    for (const std::uint32_t i : here->second) count += lies_over(splats_[i], x);
    return count;
  }

 private:
  struct Splat {
    Vec3 center, normal, major_axis, minor_axis;
    double major, minor;
  };
  using GridCell = std::array<std::int64_t, 3>;

  static bool lies_over(const Splat& s, Vec3 x) {
    const Vec3 d = x - s.center;
    const double u = dot(d, s.major_axis) / s.major, v = dot(d, s.minor_axis) / s.minor;
    return u * u + v * v <= 1 && std::abs(dot(d, s.normal)) <= kHeight * s.major;
  }

  /// Adds every splat to all cells that its bounding ball touches.
  void fill_grid() {
    std::vector<double> lengths;
    for (const Splat& s : splats_) lengths.push_back(s.major);
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    side_ = 2 * *middle;
    for (std::uint32_t i = 0; i < splats_.size(); ++i) {
      const double r = splats_[i].major * (1 + kHeight);
      const GridCell low = cell_of(splats_[i].center - Vec3{r, r, r}),
                     high = cell_of(splats_[i].center + Vec3{r, r, r});
      for (std::int64_t x = low[0]; x <= high[0]; ++x)
        for (std::int64_t y = low[1]; y <= high[1]; ++y)
          for (std::int64_t z = low[2]; z <= high[2]; ++z) grid_[key({x, y, z})].push_back(i);
    }
  }

  GridCell cell_of(Vec3 p) const {
    GridCell cell{};
    for (int a = 0; a < 3; ++a) cell[static_cast<std::size_t>(a)] = static_cast<std::int64_t>(std::floor(p[a] / side_));
    return cell;
  }
  /// Returns a key of a cell, unique for cells within a million cells of the origin.
  static std::uint64_t key(GridCell c) {
    std::uint64_t k = 0;
    for (const std::int64_t v : c) k = k << 21 | (static_cast<std::uint64_t>(v + (1 << 20)) & 0x1FFFFF);
    return k;
  }

  std::vector<Splat> splats_;
  double side_ = 1;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> grid_;
};

/// The share of a surface that no splat covers, and the mean number of splats over a point.
struct Covered {
  double bare = 0, depth = 0;
};

inline Covered covered(const SplatCover& cover, const std::vector<Vec3>& surface) {
  Covered c;
  for (const Vec3& x : surface) {
    const std::size_t over = cover.over(x);
    c.bare += over == 0, c.depth += static_cast<double>(over);
  }
  const auto n = static_cast<double>(surface.size());
  return {c.bare / n, c.depth / n};
}

}  // namespace pointsweep
