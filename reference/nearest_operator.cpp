// SPDX-License-Identifier: MIT
#include "reference/nearest_operator.h"

#include <algorithm>

#include "pointsweep/cancellation.h"

namespace pointsweep::reference {

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
  // Later points only push out neighbours or have larger indices, so this stays a lower bound.
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
