// SPDX-License-Identifier: MIT
#include "pointsweep/points/degenerate_points.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace pointsweep {

DegenerateRows::DegenerateRows(std::uint64_t count, std::vector<std::uint64_t> lowest)
    : count_(count), heap_(std::move(lowest)) {
  assert(heap_.size() <= kMostListed && heap_.size() <= count_);
  std::ranges::make_heap(heap_);
}

void DegenerateRows::add(std::uint64_t row) {
  ++count_;
  keep(row);
}

void DegenerateRows::add(const DegenerateRows& others) {
  count_ += others.count_;
  for (const std::uint64_t row : others.heap_) keep(row);
}

std::vector<std::uint64_t> DegenerateRows::lowest() const {
  std::vector<std::uint64_t> rows = heap_;
  std::ranges::sort(rows);
  return rows;
}

void DegenerateRows::keep(std::uint64_t row) {
  if (heap_.size() == kMostListed) {
    if (row >= heap_.front()) return;
    std::ranges::pop_heap(heap_);
    heap_.pop_back();
  }
  heap_.push_back(row);
  std::ranges::push_heap(heap_);
}

void add_rows(std::vector<DegenerateRows>& to, const std::vector<DegenerateRows>& from) {
  if (to.size() < from.size()) to.resize(from.size());
  for (std::size_t s = 0; s < from.size(); ++s) to[s].add(from[s]);
}

}  // namespace pointsweep
