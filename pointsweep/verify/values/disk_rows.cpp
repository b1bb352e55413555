// SPDX-License-Identifier: MIT
/// The rows that poisson keeps, by its definition: points are visited one by one in the order of their hashes.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "pointsweep/operators/thinning/undecided_points.h"
#include "pointsweep/verify/formulas/thinning.h"
#include "pointsweep/verify/values/kept_rows.h"

namespace pointsweep {
namespace {

struct HashedRow {
  std::uint64_t hash;
  Vec3 at;
  std::uint64_t row;
  auto key() const { return std::tuple(hash, at.x, at.y, at.z, row); }
};

/// Kept points in an index by cubes a little wider than the radius.
class KeptPoints {
 public:
  explicit KeptPoints(double radius) : radius2_(radius * radius), width_(1.0001 * radius) {}

  /// Keeps p unless a kept point lies within the radius. Returns whether p is kept.
  bool offer(Vec3 p) {
    const auto from = cube_of({p.x - width_, p.y - width_, p.z - width_});
    const auto to = cube_of({p.x + width_, p.y + width_, p.z + width_});
    // Keys ascend, so that the cubes of equal x and y form one range of z.
    for (double x = from[0]; x <= to[0]; x = above(x))
      for (double y = from[1]; y <= to[1]; y = above(y))
        for (auto cube = cubes_.lower_bound({x, y, from[2]}); cube != cubes_.end(); ++cube) {
          if (cube->first > Cube{x, y, to[2]}) break;
          for (const Vec3& kept : cube->second)
            if (distance2(kept, p) <= radius2_) return false;
        }
    cubes_[cube_of(p)].push_back(p);
    return true;
  }

 private:
  using Cube = std::array<double, 3>;
  Cube cube_of(Vec3 p) const { return {std::floor(p.x / width_), std::floor(p.y / width_), std::floor(p.z / width_)}; }
  /// Returns the next number of a cube. From 2^52 on, it is the next double.
  static double above(double number) {
    return std::abs(number) < 0x1p52 ? number + 1 : std::nextafter(number, HUGE_VAL);
  }

  double radius2_, width_;
  std::map<Cube, std::vector<Vec3>> cubes_;
};

}  // namespace

std::vector<bool> rows_of_disks(InputCloud& cloud, double radius, std::uint64_t memory_bytes,
                                const PhaseProgress& progress) {
  std::vector<bool> kept(cloud.count(), true);
  KeptPoints points(radius);
  const std::uint64_t turns = 1 + cloud.count() * 2 * sizeof(HashedRow) / std::max<std::uint64_t>(memory_bytes, 1);
  const std::uint64_t share = turns == 1 ? 0 : ~std::uint64_t{0} / turns + 1;  // range of hashes of one turn
  for (std::uint64_t turn = 0; turn < turns; ++turn) {
    std::vector<HashedRow> rows;
    RowSource source(cloud);
    for_each_position(source, "reading", progress, [&](std::uint64_t row, Vec3 p) {
      if (!is_finite(p)) return;
      const std::uint64_t hash = formulas::hash_of({p.x, p.y, p.z}, kPoissonSeed);
      if (share == 0 || hash / share == turn) rows.push_back({hash, p, row});
    });
    std::ranges::sort(rows, {}, &HashedRow::key);
    for (const HashedRow& r : rows) kept[r.row] = points.offer(r.at);
  }
  return kept;
}

}  // namespace pointsweep
