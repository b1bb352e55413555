// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/thinning.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <map>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace pointsweep::formulas {

std::uint64_t mixed(std::uint64_t n) {
  n += 0x9e3779b97f4a7c15u;
  n = (n ^ (n >> 30)) * 0xbf58476d1ce4e5b9u;
  n = (n ^ (n >> 27)) * 0x94d049bb133111ebu;
  return n ^ (n >> 31);
}

std::uint64_t hash_of(const Coordinates& p, std::uint64_t seed) {
  std::uint64_t hash = seed;
  for (const double c : p) hash = mixed(hash ^ std::bit_cast<std::uint64_t>(c + 0.0));  // -0 becomes 0
  return hash;
}

bool is_in_share(std::uint64_t hash, double share) { return std::ldexp(static_cast<double>(hash / 2048), -53) < share; }

std::uint64_t part_of(std::uint64_t hash, std::uint64_t parts) {
  const std::uint64_t high = hash / 0x100000000u, low = hash % 0x100000000u;
  return (high * parts + low * parts / 0x100000000u) / 0x100000000u;
}

Coordinates voxel_of(const Coordinates& p, double size) {
  Coordinates voxel{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double quotient = p[a] / size;
    voxel[a] = std::isfinite(quotient) ? std::floor(quotient) : std::copysign(1.7976931348623157e308, quotient);
  }
  return voxel;
}

double distance2_to_center(const Coordinates& p, double size) {
  const Coordinates voxel = voxel_of(p, size);
  double square[3];
  for (std::size_t a = 0; a < 3; ++a) {
    const double off = p[a] - (voxel[a] + 0.5) * size;
    square[a] = off * off;
  }
  return (square[0] + square[1]) + square[2];
}

void Mean::add(double value) {
  if (!std::isfinite(value)) return;
  sum_ += value, magnitudes_ += std::fabs(static_cast<Real>(value)), count_ += 1;
  are_whole_ = are_whole_ && value == std::trunc(value);
  least_ = std::fmin(least_, value), most_ = std::fmax(most_, value);
}

Estimate Mean::real() const {
  if (count_ == 0) return exactly(kNaN);
  if (least_ == most_) return exactly(least_);
  const Real mean = sum_ / count_;
  return scalar(mean, 0x1p-63L * magnitudes_ + 2 * kDouble * std::fabs(mean) + 0x1p-1074L);
}

Estimate Mean::single() const {
  Estimate e = real();
  if (e.error > 0) e.error += kSingle * (std::fabs(e.value.x) + e.error) + 0x1p-149L;
  return e;
}

Estimate Mean::whole() const {
  // Sums of whole numbers below 2^53 are exact, and so is a mean that lies halfway between two whole numbers.
  if (are_whole_ && count_ > 0 && magnitudes_ < 0x1p53L && std::fmod(2 * sum_, count_) == 0)
    return exactly(std::nearbyint(sum_ / count_));
  const Estimate e = real();
  const Real low = std::nearbyint(e.value.x - e.error), high = std::nearbyint(e.value.x + e.error);
  return low == high ? exactly(low) : open();
}

Estimate mean_vector(const std::array<Mean, 3>& components) {
  const Estimate x = components[0].real(), y = components[1].real(), z = components[2].real();
  return {.value = {x.value.x, y.value.x, z.value.x}, .error = x.error + y.error + z.error};
}

Estimate mean_direction(const std::array<Mean, 3>& components) {
  const Estimate e = mean_vector(components);
  const Real size = norm(e.value);
  if (!std::isfinite(size) || (size == 0 && e.error == 0)) return undefined();
  if (!(size > 2 * e.error)) return open();
  return single_direction(unit(e.value), 2 * e.error / size + 16 * kDouble);
}

namespace {

using Steps = std::array<std::int64_t, 3>;

constexpr std::size_t kMostOfLeaf = 100'000, kMostOfRoot = 100'000;
constexpr int kDeepest = 31, kNone = -1;

struct StepsHash {
  std::size_t operator()(const Steps& s) const {
    std::uint64_t hash = 0;
    for (const std::int64_t n : s) hash = mixed(hash ^ static_cast<std::uint64_t>(n));
    return static_cast<std::size_t>(hash);
  }
};

class Levels {
 public:
  explicit Levels(const std::vector<Coordinates>& points)
      : steps_(points.size()), leaf_(points.size()), level_(points.size(), kNone) {
    round(points);
    std::vector<std::size_t> all(points.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    divide(std::move(all), 0);
  }

  std::vector<std::uint8_t> run() {
    const int deepest = leaf_.empty() ? 0 : *std::ranges::max_element(leaf_);
    double s0 = 0;
    for (int k = 0;; ++k) {
      s0 = width_ / 128 * std::exp2(0.5 * k);
      std::ranges::fill(level_, kNone);
      take(0, s0);
      const auto in_root = static_cast<std::size_t>(std::count(level_.begin(), level_.end(), 0));
      if (deepest == 0 || in_root <= kMostOfRoot) break;
    }
    for (int depth = 1; depth <= deepest; ++depth) take(depth, s0 / std::exp2(depth));
    return {level_.begin(), level_.end()};
  }

 private:
  void round(const std::vector<Coordinates>& points) {
    if (points.empty()) return;
    Coordinates lo = points[0], hi = points[0];
    for (const Coordinates& p : points)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        lo[axis] = std::min(lo[axis], p[axis]);
        hi[axis] = std::max(hi[axis], p[axis]);
      }
    const double widest = std::max({hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]});
    const double step = widest > 0 ? widest / 1073741824.0 : 1;
    std::int64_t most = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        steps_[i][axis] = static_cast<std::int64_t>(std::nearbyint((points[i][axis] - lo[axis]) / step));
        most = std::max(most, steps_[i][axis]);
      }
    // The width of the root, in steps, is the least multiple of `unit` above `most`. It is 8 to 16 times `unit` unless
    // the extent is below 128 steps.
    std::int64_t unit = 8;
    while (unit * 16 <= most + 1) unit *= 2;
    width_ = static_cast<double>((most + unit) / unit * unit);
  }

  /// Returns the indices along x, y and z of the octant of this depth that holds point `i`.
  Steps octant(std::size_t i, int depth) const {
    Steps at;
    for (std::size_t axis = 0; axis < 3; ++axis)
      at[axis] = static_cast<std::int64_t>((static_cast<double>(steps_[i][axis]) + 0.5) * (2147483648.0 / width_)) >>
                 (kDeepest - depth);
    return at;
  }

  void divide(std::vector<std::size_t> rows, int depth) {
    const bool is_one_place = std::ranges::all_of(rows, [&](std::size_t i) { return steps_[i] == steps_[rows[0]]; });
    if (rows.size() <= kMostOfLeaf || is_one_place || depth == kDeepest) {
      for (const std::size_t i : rows) leaf_[i] = depth;
      return;
    }
    std::map<Steps, std::vector<std::size_t>> children;
    for (const std::size_t i : rows) children[octant(i, depth + 1)].push_back(i);
    rows = {};
    for (auto& [at, child] : children) divide(std::move(child), depth + 1);
  }

  void take(int depth, double spacing) {
    for (std::size_t i = 0; i < level_.size(); ++i)
      if (level_[i] == kNone && leaf_[i] == depth) level_[i] = depth;
    // Cells are slightly wider than the spacing, so that all points nearer than the spacing lie in the same cell or in
    // adjacent ones.
    Cells cells;
    const double edge = spacing * 1.0001;
    const auto cell = [&](std::size_t i) {
      Steps at;
      for (std::size_t axis = 0; axis < 3; ++axis)
        at[axis] = static_cast<std::int64_t>(std::floor(static_cast<double>(steps_[i][axis]) / edge));
      return at;
    };
    for (std::size_t i = 0; i < level_.size(); ++i)
      if (level_[i] != kNone) cells[cell(i)].push_back(i);
    std::vector<std::tuple<std::int64_t, std::uint64_t, std::size_t>> turns;
    for (std::size_t i = 0; i < level_.size(); ++i) {
      if (leaf_[i] <= depth) continue;
      const Steps at = octant(i, depth);
      turns.emplace_back((at[0] & 1) + 2 * (at[1] & 1) + 4 * (at[2] & 1), rank(i), i);
    }
    std::ranges::sort(turns, [&](const auto& a, const auto& b) {
      const auto key = [&](const auto& t) {
        return std::tuple(std::get<0>(t), std::get<1>(t), steps_[std::get<2>(t)], std::get<2>(t));
      };
      return key(a) < key(b);
    });
    for (const auto& [parity, rank, i] : turns) {
      if (level_[i] != kNone || is_near(i, cells, cell(i), spacing)) continue;
      level_[i] = depth;
      cells[cell(i)].push_back(i);
    }
  }

  using Cells = std::unordered_map<Steps, std::vector<std::size_t>, StepsHash>;

  std::uint64_t rank(std::size_t i) const {
    const auto [x, y, z] = steps_[i];
    return mixed(mixed(static_cast<std::uint64_t>(x) + (static_cast<std::uint64_t>(y) << 32)) ^
                 static_cast<std::uint64_t>(z));
  }

  bool is_near(std::size_t i, const Cells& cells, const Steps& at, double spacing) const {
    for (std::int64_t dx = -1; dx <= 1; ++dx)
      for (std::int64_t dy = -1; dy <= 1; ++dy)
        for (std::int64_t dz = -1; dz <= 1; ++dz) {
          const auto found = cells.find({at[0] + dx, at[1] + dy, at[2] + dz});
          if (found == cells.end()) continue;
          for (const std::size_t j : found->second) {
            double sum = 0;
            for (std::size_t axis = 0; axis < 3; ++axis) {
              const auto d = static_cast<double>(steps_[i][axis] - steps_[j][axis]);
              sum += d * d;
            }
            if (sum < spacing * spacing) return true;
          }
        }
    return false;
  }

  std::vector<Steps> steps_;
  std::vector<int> leaf_, level_;
  double width_ = 8;
};

}  // namespace

std::vector<std::uint8_t> levels_of(const std::vector<Coordinates>& points) { return Levels(points).run(); }

}  // namespace pointsweep::formulas
