// SPDX-License-Identifier: MIT
#include "pointsweep/verify/search/nearest_in_stream.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "pointsweep/cancellation.h"

namespace pointsweep {
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
  std::map<Key, std::size_t> known;  // equal places have equal answers
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
