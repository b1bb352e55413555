// SPDX-License-Identifier: MIT
#include "pointsweep/info/nearest_distances.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pointsweep {
namespace {

constexpr std::uint32_t kLeaf = 8;
constexpr double kInf = std::numeric_limits<double>::infinity();

}  // namespace

NearestDistances::NearestDistances(std::vector<Sampled> sample)
    : sample_(std::move(sample)), nearest2_(sample_.size(), kInf) {
  if (!sample_.empty()) build(0, static_cast<std::uint32_t>(sample_.size()));
}

void NearestDistances::build(std::uint32_t begin, std::uint32_t end) {
  Node node{{}, kInf, begin, end, 0};
  for (std::uint32_t i = begin; i < end; ++i) node.box.include(sample_[i].position);
  const std::size_t index = nodes_.size();
  nodes_.push_back(node);
  if (end - begin <= kLeaf) return;
  const int axis = node.box.longest_axis();
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(sample_.begin() + begin, sample_.begin() + middle, sample_.begin() + end,
                   [axis](const Sampled& a, const Sampled& b) { return a.position[axis] < b.position[axis]; });
  build(begin, middle);
  nodes_[index].above = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end);
}

void NearestDistances::add(Vec3 position, std::uint64_t row) {
  if (!nodes_.empty()) visit(0, position, row);
}

void NearestDistances::visit(std::uint32_t index, Vec3 position, std::uint64_t row) {
  Node& node = nodes_[index];
  if (distance2(node.box, position) >= node.farthest2) return;
  if (node.above != 0) {
    visit(index + 1, position, row);
    visit(node.above, position, row);
    node.farthest2 = std::max(nodes_[index + 1].farthest2, nodes_[node.above].farthest2);
    return;
  }
  node.farthest2 = 0;
  for (std::uint32_t i = node.begin; i < node.end; ++i) {
    if (sample_[i].row != row) {
      const Vec3 d = sample_[i].position - position;
      nearest2_[i] = std::min(nearest2_[i], dot(d, d));
    }
    node.farthest2 = std::max(node.farthest2, nearest2_[i]);
  }
}

std::vector<double> NearestDistances::distances() const {
  std::vector<double> found;
  for (const double d2 : nearest2_)
    if (d2 < kInf) found.push_back(std::sqrt(d2));
  std::ranges::sort(found);
  return found;
}

}  // namespace pointsweep
