// SPDX-License-Identifier: MIT
#include "reference/nearest_operator.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "pointsweep/cancellation.h"

namespace pointsweep::reference {

std::vector<Rank> ranks_of(std::span<const Neighbor> neighbors) {
  std::vector<Rank> ranks;
  ranks.reserve(neighbors.size());
  for (const Neighbor& neighbor : neighbors) ranks.push_back(neighbor.rank());
  return ranks;
}

RuledPoint Shortening::ruled(StreamPoint& point) const {
  RuledPoint ruled{point.input, point.row, {}};
  for (const Field& field : reads_)
    ruled.attributes.insert(ruled.attributes.end(), field.in(point), field.in(point) + field.bytes);
  return ruled;
}

std::size_t Shortening::kept(const RuledPoint& point, std::span<const Rank> nearest_first) {
  if (!rule_) return nearest_first.size();
  x_.clear(), y_.clear(), z_.clear(), row_.clear(), slots_.clear();
  for (const Rank& rank : nearest_first) {
    x_.push_back(rank.position.x), y_.push_back(rank.position.y), z_.push_back(rank.position.z);
    row_.push_back(rank.row);
  }
  for (std::size_t i = 0; i < row_.size(); i += kCellCapacity)
    slots_.push_back({&x_[i], &y_[i], &z_[i], &row_[i], nullptr});
  while (refs_.size() < row_.size()) refs_.push_back(static_cast<NeighborRef>(refs_.size()));

  std::vector<const std::byte*> columns;
  std::vector<std::uint16_t> reads(reads_.size());
  std::iota(reads.begin(), reads.end(), std::uint16_t{0});
  const std::byte* value = point.attributes.data();
  for (const Field& field : reads_) columns.push_back(value), value += field.bytes;
  const PointColumns own{&point.position.x, &point.position.y, &point.position.z, &point.row, columns.data()};
  const std::array<std::uint32_t, 2> begin = {0, static_cast<std::uint32_t>(row_.size())};
  std::uint32_t count = 0;
  rule_->choose(Neighborhoods(own, 1, slots_.data(), begin.data(), refs_.data(), reads, {}), {&count, 1});
  return std::min<std::size_t>(count, row_.size());
}

void Shortening::shorten(StreamPoint& point) {
  if (rule_) point.neighbors.keep(kept(ruled(point), ranks_of(point.neighbors.found())));
}

void NearestOperator::pull_push() {
  arrived_.clear();
  completed_.clear();
  while (StreamPoint* point = prev_->front()) {
    stop_if_cancelled();
    prev_->pop_front();
    arrive(*point);
    searched_.take_passed(point->input[sweep_axis_], completed_);
  }
  if (arrived_.empty() && prev_->smallest_element() == kNoIndex && !searched_.empty()) {
    completed_.push_back(&searched_.smallest());
    searched_.pop_smallest();
  }
  for (StreamPoint* point : completed_) complete(*point);
}

void NearestOperator::arrive(StreamPoint& point) {
  searched_.find_nearest(point.input, point.neighbors);
  searched_.offer_to_all(point);
  searched_.insert(point);
  // Later points only push out neighbours or have larger indices, so min_index stays a lower bound.
  point.min_index = point.index;
  for (const Neighbor& neighbor : point.neighbors.found())
    point.min_index = std::min(point.min_index, neighbor.point->index);
  references_.push(point);
  arrived_.push_back(&point);
}

void NearestOperator::complete(StreamPoint& point) {
  point.neighbors.sort();
  shortening_.shorten(point);
  point.min_index = point.max_index = point.index;
  for (const Neighbor& neighbor : point.neighbors.kept()) {
    point.min_index = std::min(point.min_index, neighbor.point->index);
    point.max_index = std::max(point.max_index, neighbor.point->index);
  }
  sorting_.push(&point);
}

StreamPoint* NearestOperator::front() {
  if (sorting_.empty()) return nullptr;
  StreamPoint* first = sorting_.top();
  return searched_.empty() || first->index < searched_.smallest().index ? first : nullptr;
}

std::uint64_t NearestOperator::smallest_element() {
  std::uint64_t smallest = prev_->smallest_element();
  if (!searched_.empty()) smallest = std::min(smallest, searched_.smallest().index);
  if (!sorting_.empty()) smallest = std::min(smallest, sorting_.top()->index);
  return smallest;
}

std::uint64_t NearestOperator::smallest_reference() {
  return std::min(prev_->smallest_reference(), references_.smallest(smallest_element()));
}

}  // namespace pointsweep::reference
