// SPDX-License-Identifier: MIT
#include "pointsweep/order/local_spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ranges>

#include "pointsweep/fail.h"
#include "pointsweep/math/box.h"
#include "pointsweep/math/sort.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr Encoding kSpacingEncoding{"local spacing", 1};
/// Side of the root cube, relative to the extent of the middle 98 % of the sample. With 2, faces of cubes would lie at
/// the ends of that extent: the outermost points of a uniform cloud would be alone in large cubes and seem sparse.
constexpr double kRootSide = 2.1;
constexpr int kLevels = 21;          ///< depth of the octree: three indices of this many bits fit in 64 bits
constexpr int kTableLevels = 4;      ///< the table of runs has an entry for each cube of this level
constexpr std::size_t kFew = 16;     ///< each leaf has fewer sample points than this
constexpr double kInLeaf = 6;        ///< average number of sample points in a leaf that a surface crosses
constexpr int kSparser = 4;          ///< a sparse leaf is this many levels coarser than the median: 16 times as wide
constexpr std::size_t kLeast = 8;    ///< sparse places need at least this many sample points to count
constexpr double kFarAway = 0x1p60;  ///< larger distances count as this distance, in sides of the root cube

constexpr std::uint64_t spread(std::uint64_t v) {
  v = (v | v << 32) & 0x1f00000000ffff;
  v = (v | v << 16) & 0x1f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  return (v | v << 2) & 0x1249249249249249;
}

constexpr std::uint64_t codes_of_cube(int level) { return std::uint64_t{1} << 3 * (kLevels - level); }

}  // namespace

LocalSpacing::LocalSpacing(std::span<const Vec3> sample, std::uint64_t points, double dimension) {
  if (sample.size() < kFew) return;
  const Box most = middle_box(sample);
  const Vec3 extent = most.extent();
  side_ = kRootSide * std::max({extent.x, extent.y, extent.z});
  lo_ = most.center() - Vec3{side_ / 2, side_ / 2, side_ / 2};
  inverse_side_ = 1 / side_;
  if (!std::isfinite(side_) || !std::isfinite(inverse_side_)) return;
  std::vector<std::uint64_t> codes;
  for (const Vec3& p : sample) {
    if (inside(p)) codes.push_back(code_of(p));
  }
  sort_ascending(std::span(codes));
  std::vector<Leaf> leaves;
  grow(codes, 0, 0, leaves);
  const std::vector<int> levels = levels_of(sample, leaves);
  const double sampled = static_cast<double>(sample.size()) / static_cast<double>(std::max<std::uint64_t>(points, 1));
  const double leaf_to_spacing = side_ * std::pow(std::min(sampled, 1.0) / kInLeaf, 1 / dimension);
  for (const int level : levels) at_sample_.push_back(std::ldexp(leaf_to_spacing, -level));
  find_sparse_places(levels, leaves);
}

void LocalSpacing::encode(Encoder& out) const {
  out.begin(kSpacingEncoding);
  out.put_point(lo_);
  out.put<double>(side_);
  out.put<std::int32_t>(sparse_level_);
  out.put_numbers<std::uint64_t>(begin_);
  out.put_numbers<std::uint32_t>(first_);
}

LocalSpacing LocalSpacing::decode(Decoder& in) {
  in.begin(kSpacingEncoding);
  LocalSpacing spacing;
  spacing.lo_ = in.get_point();
  spacing.side_ = in.get<double>();
  spacing.inverse_side_ = 1 / spacing.side_;
  spacing.sparse_level_ = in.get<std::int32_t>();
  spacing.begin_ = in.get_numbers<std::uint64_t>();
  spacing.first_ = in.get_numbers<std::uint32_t>();
  const std::size_t runs = spacing.begin_.size(), cubes = codes_of_cube(0) / codes_of_cube(kTableLevels) + 1;
  const bool has_table =
      spacing.first_.size() == cubes && std::ranges::is_sorted(spacing.first_) && spacing.first_.back() < runs;
  if (runs == 0 ? !spacing.first_.empty() : !has_table) fail("The table of the local spacing of a cloud is damaged.");
  return spacing;
}

void LocalSpacing::grow(std::span<const std::uint64_t> codes, std::uint64_t begin, int level,
                        std::vector<Leaf>& leaves) {
  if (codes.size() < kFew || level == kLevels) return leaves.push_back({begin, level});
  for (int child = 0; child < 8; ++child) {
    const std::uint64_t end = begin + codes_of_cube(level + 1);
    const auto count = static_cast<std::size_t>(std::ranges::lower_bound(codes, end) - codes.begin());
    grow(codes.first(count), begin, level + 1, leaves);
    codes = codes.subspan(count);
    begin = end;
  }
}

std::vector<int> LocalSpacing::levels_of(std::span<const Vec3> sample, const std::vector<Leaf>& leaves) const {
  constexpr std::size_t kTogether = 4096;
  std::vector<int> levels(sample.size());
  // For each cube of the table, the index of the leaf that holds its first code. Later codes of the cube are in this
  // leaf or in later leaves.
  std::vector<std::ptrdiff_t> first;
  for (std::uint64_t cube = 0; cube <= codes_of_cube(0) / codes_of_cube(kTableLevels); ++cube) {
    const auto after = std::ranges::upper_bound(leaves, cube * codes_of_cube(kTableLevels), {}, &Leaf::begin);
    first.push_back(after - leaves.begin() - 1);
  }
  const auto level_inside = [&](std::uint64_t code) {
    const std::uint64_t cube = code / codes_of_cube(kTableLevels);
    const std::ranges::subrange some(leaves.begin() + first[cube], leaves.begin() + first[cube + 1] + 1);
    return std::ranges::upper_bound(some, code, {}, &Leaf::begin)[-1].level;
  };
  parallel_for((sample.size() + kTogether - 1) / kTogether, [&](std::size_t part, unsigned) {
    for (std::size_t i = part * kTogether; i < std::min((part + 1) * kTogether, sample.size()); ++i)
      levels[i] = inside(sample[i]) ? level_inside(code_of(sample[i])) : level_outside(sample[i]);
  });
  return levels;
}

/// Stores the leaves as alternating runs of sparse and of other leaves, with a table that has, for each cube of a
/// coarse level, the run of its first code.
void LocalSpacing::find_sparse_places(const std::vector<int>& levels, const std::vector<Leaf>& leaves) {
  std::vector<int> sorted = levels;
  std::ranges::sort(sorted);
  sparse_level_ = sorted[sorted.size() / 2] - kSparser;
  const auto sparse_points = std::ranges::upper_bound(sorted, sparse_level_) - sorted.begin();
  if (sparse_points < static_cast<std::ptrdiff_t>(std::max(kLeast, sorted.size() / 2048))) return;
  begin_.push_back(0);
  for (const Leaf& leaf : leaves) {
    const bool sparse = leaf.level <= sparse_level_, in_sparse_run = begin_.size() % 2 == 0;
    if (sparse != in_sparse_run) begin_.push_back(leaf.begin);
  }
  for (std::uint64_t cube = 0; cube <= codes_of_cube(0) / codes_of_cube(kTableLevels); ++cube) {
    const auto after = std::ranges::upper_bound(begin_, cube * codes_of_cube(kTableLevels));
    first_.push_back(static_cast<std::uint32_t>(after - begin_.begin()) - 1);
  }
}

bool LocalSpacing::is_sparse(Vec3 p) const {
  if (!has_sparse_places()) return false;
  if (!inside(p)) return level_outside(p) <= sparse_level_;
  // Most cubes of the table lie within one run, so that the leading bits of the code are enough.
  static constexpr auto kSpread = [] {
    std::array<std::uint32_t, 1 << kTableLevels> spreads{};
    for (std::uint64_t v = 0; v < spreads.size(); ++v) spreads[v] = static_cast<std::uint32_t>(spread(v));
    return spreads;
  }();
  const auto leading = [&](int axis) { return kSpread[index(p, axis) >> (kLevels - kTableLevels)]; };
  const std::uint32_t cube = leading(0) | leading(1) << 1 | leading(2) << 2;
  const std::uint32_t first = first_[cube], last = first_[cube + 1];
  if (first == last) return first % 2 == 1;
  const auto run = std::upper_bound(begin_.begin() + first + 1, begin_.begin() + last + 1, code_of(p));
  return (run - begin_.begin()) % 2 == 0;
}

bool LocalSpacing::inside(Vec3 p) const {
  const Vec3 d = p - lo_;
  return 0 <= d.x && d.x < side_ && 0 <= d.y && d.y < side_ && 0 <= d.z && d.z < side_;
}

std::uint64_t LocalSpacing::index(Vec3 p, int axis) const {
  constexpr double kCubes = 1 << kLevels;
  return static_cast<std::uint64_t>(std::min((p[axis] - lo_[axis]) * inverse_side_ * kCubes, kCubes - 1));
}

std::uint64_t LocalSpacing::code_of(Vec3 p) const {
  return spread(index(p, 0)) | spread(index(p, 1)) << 1 | spread(index(p, 2)) << 2;
}

/// Returns the level of a place outside the root cube. The level is 0 up to a distance of two sides of the root
/// cube, and one lower for each further doubling of the distance up to kFarAway.
int LocalSpacing::level_outside(Vec3 p) const {
  double distance = 0;
  for (int axis = 0; axis < 3; ++axis)
    distance = std::max({distance, lo_[axis] - p[axis], p[axis] - (lo_[axis] + side_)});
  const double sides = std::min(distance / side_, kFarAway);
  return sides < 1 ? 0 : -std::ilogb(sides);
}

}  // namespace pointsweep
