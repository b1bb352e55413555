// SPDX-License-Identifier: MIT
#include "pointsweep/order/waiting_estimate.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "pointsweep/math/sort.h"

namespace pointsweep {

std::uint64_t estimate_waiting(std::span<const RowBox> boxes, int axis, std::span<const Vec3> sample,
                               std::uint64_t points, std::uint64_t slab_points, std::size_t ahead) {
  if (sample.empty() || slab_points == 0) return points;
  std::vector<double> along;
  for (const Vec3& p : sample) along.push_back(p[axis]);
  sort_ascending(std::span(along));
  std::vector<std::pair<double, std::uint64_t>> begins;  // for each box: its least coordinate along the axis, and its
                                                         // rows
  for (const RowBox& box : boxes) {
    const double begin = box.box.lo[axis];
    begins.emplace_back(begin == begin ? begin : -Box::kInf, box.rows);
  }
  std::ranges::sort(begins);
  std::uint64_t most = 0, decoded = 0;
  std::size_t next = 0;
  for (std::uint64_t handed_over = 0; handed_over < points; handed_over += slab_points) {
    const std::uint64_t read = handed_over + slab_points * std::max<std::size_t>(ahead, 1);
    // The front of decoding: all boxes that begin before it are decoded.
    const double share = static_cast<double>(read) / static_cast<double>(points);
    const auto at = static_cast<std::size_t>(share * static_cast<double>(along.size()));
    for (; next < begins.size() && (at >= along.size() || begins[next].first <= along[at]); ++next)
      decoded += begins[next].second;
    most = std::max(most, decoded - std::min(decoded, handed_over));
  }
  return std::min(most, points);
}

}  // namespace pointsweep
