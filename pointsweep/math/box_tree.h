// SPDX-License-Identifier: MIT
/// A tree of boxes with a fast search for boxes near a place.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "pointsweep/math/box.h"

namespace pointsweep {

/// A binary tree of boxes that do not change. Queries are thread-safe.
class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    if (!boxes_.empty()) build(order_);
  }

  /// Returns whether accept(number) is true for the number of a box within sqrt(reach2) of `place`, which is a box or a
  /// point. Calls accept() for boxes in any order, until it returns true.
  template <class Place, class Accept>
  bool any_within(const Place& place, double reach2, Accept accept) const {
    return !nodes_.empty() && any_within(0, place, reach2, accept);
  }

 private:
  static constexpr std::size_t kLeafBoxes = 4;
  struct Node {
    Box box;
    std::uint32_t first, end;  ///< range of the node's boxes in order_
    std::uint32_t second = 0;  ///< number of the second child (the first child is the next node); 0 in a leaf
  };

  void build(std::span<std::uint32_t> numbers) {
    const std::size_t node = nodes_.size();
    const auto first = static_cast<std::uint32_t>(numbers.data() - order_.data());
    nodes_.push_back({{}, first, first + static_cast<std::uint32_t>(numbers.size())});
    Box centers;
    for (const std::uint32_t i : numbers) nodes_[node].box.include(boxes_[i]), centers.include(boxes_[i].center());
    if (numbers.size() <= kLeafBoxes) return;
    const int axis = centers.longest_axis();
    const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
    std::ranges::nth_element(numbers, middle, {}, [&](std::uint32_t i) { return boxes_[i].center()[axis]; });
    build({numbers.begin(), middle});
    nodes_[node].second = static_cast<std::uint32_t>(nodes_.size());
    build({middle, numbers.end()});
  }

  template <class Place, class Accept>
  bool any_within(std::uint32_t number, const Place& place, double reach2, Accept& accept) const {
    const Node& node = nodes_[number];
    if (distance2(node.box, place) > reach2) return false;
    if (node.second != 0)
      return any_within(number + 1, place, reach2, accept) || any_within(node.second, place, reach2, accept);
    return std::any_of(order_.begin() + node.first, order_.begin() + node.end,
                       [&](std::uint32_t i) { return distance2(boxes_[i], place) <= reach2 && accept(i); });
  }

  std::vector<Box> boxes_;
  std::vector<std::uint32_t> order_;  ///< numbers of the boxes, by leaf
  std::vector<Node> nodes_;
};

}  // namespace pointsweep
