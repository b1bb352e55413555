// SPDX-License-Identifier: MIT
#include "pointsweep/verify/search/nearest_in_stream.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <tuple>

#include "pointsweep/cancellation.h"
#include "pointsweep/math/box.h"

namespace pointsweep {
namespace {

constexpr int kFinest = 30;  ///< the finest grid divides the extent by 2^30

/// Returns slightly more than the square root, so that rounding, also of squares below the range of double, excludes no
/// point.
double radius_of(double reach2) { return std::sqrt(reach2) * (1 + 1e-9) + 1e-150; }

/// Returns the level of the finest grid over `extent` whose cells are at least `width` wide; 0 if even one cell over
/// all of `extent` is narrower.
int level_of(double width, double extent) {
  int level = 0;
  while (level < kFinest && std::ldexp(extent, -(level + 1)) >= width) ++level;
  return level;
}

}  // namespace

BallIndex::BallIndex(const std::vector<Vec3>& centers, const std::vector<double>& reach2) {
  Box box;
  for (const Vec3 c : centers) box.include(c);
  low_ = box.lo;
  const Vec3 size = box.extent();
  const double extent = std::max({size.x, size.y, size.z});
  std::vector<double> radius;
  std::array<std::vector<std::uint32_t>, kFinest + 1> levels;
  for (std::size_t i = 0; i < centers.size(); ++i) {
    radius.push_back(radius_of(reach2[i]));
    levels[static_cast<std::size_t>(level_of(2 * radius[i], extent))].push_back(static_cast<std::uint32_t>(i));
  }
  for (int level = 0; level <= kFinest; ++level) {
    const auto& members = levels[static_cast<std::size_t>(level)];
    if (members.empty()) continue;
    Grid& grid = grids_.emplace_back();
    grid.per_length = extent > 0 ? std::ldexp(1 / extent, level) : 0;
    grid.last = std::ldexp(1, level);
    fill(grid, members, centers, radius);
  }
}

void BallIndex::fill(Grid& grid, const std::vector<std::uint32_t>& members, const std::vector<Vec3>& centers,
                     const std::vector<double>& radius) const {
  grid.mask = std::bit_ceil(static_cast<std::uint32_t>(members.size()) * 8) - 1;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> entries;  // number of a bucket and number of a ball
  std::vector<std::uint32_t> buckets;
  for (const std::uint32_t ball : members) {
    stop_if_cancelled();
    const Vec3 c = centers[ball];
    const double r = radius[ball];
    const Cell lo = grid.cell({c.x - r, c.y - r, c.z - r}, low_), hi = grid.cell({c.x + r, c.y + r, c.z + r}, low_);
    buckets.clear();
    for (std::uint32_t x = lo[0]; x <= hi[0]; ++x)
      for (std::uint32_t y = lo[1]; y <= hi[1]; ++y)
        for (std::uint32_t z = lo[2]; z <= hi[2]; ++z) buckets.push_back(grid.bucket({x, y, z}));
    std::ranges::sort(buckets);
    buckets.erase(std::unique(buckets.begin(), buckets.end()), buckets.end());
    for (const std::uint32_t bucket : buckets) entries.emplace_back(bucket, ball);
  }
  std::ranges::sort(entries);
  grid.begin.assign(std::size_t{grid.mask} + 2, 0);
  for (const auto& [bucket, ball] : entries) ++grid.begin[bucket + 1], grid.balls.push_back(ball);
  for (std::size_t b = 1; b < grid.begin.size(); ++b) grid.begin[b] += grid.begin[b - 1];
}

namespace {

constexpr std::uint64_t kThin = 65536;

using Key = std::tuple<double, double, double>;

}  // namespace

bool operator<(const NearPoint& a, const NearPoint& b) {
  const auto key = [](const NearPoint& p) {
    return std::tie(p.distance2, p.position.x, p.position.y, p.position.z, p.row);
  };
  return key(a) < key(b);
}

NearestInStream::NearestInStream(std::vector<Vec3> places, std::vector<double> reach2, std::size_t most, Space space)
    : places_(std::move(places)),
      reach2_(std::move(reach2)),
      most_(most),
      space_(space),
      found_(places_.size()),
      index_(places_, reach2_) {}

void NearestInStream::offer(Vec3 p, std::uint64_t row) {
  stop_if_cancelled();
  if (!is_finite(p)) return;
  const Vec3 at = space_ == Space::plane ? Vec3{p.x, p.y, 0} : p;
  index_.visit(at, [&](std::uint32_t place) {
    const double d2 = distance2(places_[place], at);
    if (!(d2 <= reach2_[place])) return;
    std::vector<NearPoint>& found = found_[place];
    const NearPoint candidate{d2, p, row};
    if (found.size() == most_) {
      if (!(candidate < found.front())) return;
      std::pop_heap(found.begin(), found.end());
      found.back() = candidate;
    } else {
      found.push_back(candidate);
    }
    if (most_ != kAll) std::push_heap(found.begin(), found.end());
    if (found.size() == most_) reach2_[place] = std::min(reach2_[place], found.front().distance2);
  });
}

std::vector<NearPoint>& NearestInStream::nearest(std::size_t place) {
  stop_if_cancelled();
  std::sort(found_[place].begin(), found_[place].end());
  return found_[place];
}

/// Finds the bounds in two rounds: a few points give rough bounds, with which all points then give closer bounds.
std::vector<double> bounds_of_reach2(const std::vector<Vec3>& places, std::vector<double> reach2, std::size_t most,
                                     std::span<const KnownPoint> some, NearestInStream::Space space) {
  constexpr std::size_t kFew = 1024;
  for (const std::size_t stride : {std::max<std::size_t>(1, some.size() / std::max(kFew, 8 * most)), std::size_t{1}}) {
    NearestInStream nearest(places, reach2, most, space);
    for (std::size_t i = 0; i < some.size(); i += stride) nearest.offer(some[i].position, some[i].row);
    for (std::size_t i = 0; i < places.size(); ++i) reach2[i] = nearest.reach2(i);
  }
  return reach2;
}

std::vector<std::vector<NearPoint>> nearest_of_cloud(std::span<const Vec3> places, const PointsOfCloud& points,
                                                     std::uint64_t count, const NearestQuery& query) {
  const bool flat = query.space == NearestInStream::Space::plane;
  std::map<Key, std::size_t> known;  // number of each different place, since equal places have equal neighbours
  std::vector<Vec3> different;
  std::vector<std::size_t> number;
  for (const Vec3 p : places) {
    const auto [at, is_new] = known.try_emplace({p.x, p.y, flat ? 0 : p.z}, different.size());
    if (is_new) different.push_back({p.x, p.y, flat ? 0 : p.z});
    number.push_back(at->second);
  }
  const std::uint64_t stride = std::max<std::uint64_t>(1, count / kThin);
  std::vector<KnownPoint> thin;
  std::uint64_t seen = 0;
  points([&](std::uint64_t row, Vec3 p) {
    if (seen++ % stride == 0 && is_finite(p)) thin.push_back({p, row});
  });
  const std::vector<double> reach2 =
      bounds_of_reach2(different, std::vector<double>(different.size(), query.reach2), query.most, thin, query.space);
  NearestInStream nearest(different, reach2, query.most, query.space);
  points([&](std::uint64_t row, Vec3 p) { nearest.offer(p, row); });
  std::vector<std::vector<NearPoint>> found;
  for (const std::size_t n : number) found.push_back(nearest.nearest(n));
  return found;
}

}  // namespace pointsweep
