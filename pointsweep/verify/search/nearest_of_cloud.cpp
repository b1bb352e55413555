// SPDX-License-Identifier: MIT
#include "pointsweep/verify/search/nearest_of_cloud.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace pointsweep {
namespace {

constexpr std::uint64_t kThin = 65536;

using Key = std::tuple<double, double, double>;

}  // namespace

std::vector<std::vector<NearPoint>> nearest_of_cloud(std::span<const Vec3> places, const PointsOfCloud& points,
                                                     std::uint64_t count, const NearestQuery& query) {
  const bool flat = query.space == NearestInStream::Space::plane;
  std::map<Key, std::size_t> known;  // places that are equal have the same answer
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
