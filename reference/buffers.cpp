// SPDX-License-Identifier: MIT
#include "reference/buffers.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>
#include <numeric>

namespace pointsweep::reference {
namespace {

constexpr std::size_t kMostPoints = 64;  ///< most points gathered at once, which bounds the memory of a call
constexpr std::size_t kMostNeighbors = 16384;

std::vector<std::uint16_t> numbers(std::size_t n) {
  std::vector<std::uint16_t> out(n);
  std::iota(out.begin(), out.end(), std::uint16_t{0});
  return out;
}

}  // namespace

void OperatorCall::Gathered::start(std::size_t attributes) {
  x.clear(), y.clear(), z.clear(), row.clear();
  values.resize(attributes);
  for (auto& column : values) column.clear();
}

void OperatorCall::Gathered::add(Vec3 position, const StreamPoint& point) {
  x.push_back(position.x), y.push_back(position.y), z.push_back(position.z);
  row.push_back(point.row);
}

void OperatorCall::Gathered::add_values(StreamPoint& point, const std::vector<Field>& fields) {
  for (std::size_t a = 0; a < fields.size(); ++a)
    values[a].insert(values[a].end(), fields[a].in(point), fields[a].in(point) + fields[a].bytes);
}

void OperatorCall::copy_fields(StreamPoint& point) const {
  for (const Copy& copy : stage_.copies) std::memcpy(copy.to.in(point), copy.from.in(point), copy.from.bytes);
}

/// applyOperator of the paper's Figures 12 and 14: passes points to an operator's formula, and stores the results in
/// the points.
void OperatorCall::apply(std::span<StreamPoint* const> points) {
  while (!points.empty()) {
    std::size_t size = 0, neighbors = 0;
    while (size < points.size() && size < kMostPoints && (size == 0 || neighbors < kMostNeighbors))
      neighbors += points[size++]->neighbors.kept().size();
    assert(neighbors < std::numeric_limits<std::uint32_t>::max());
    gather(points.first(size));
    lay_out_slots();
    apply_gathered(points.first(size));
    points = points.subspan(size);
    between_();
  }
}

void OperatorCall::gather(std::span<StreamPoint* const> points) {
  own_.start(stage_.reads.size());
  near_.start(stage_.reads_neighbors.size());
  begin_.assign(1, 0);
  for (StreamPoint* point : points) {
    own_.add(point->position, *point);
    own_.add_values(*point, stage_.reads);
    for (const Neighbor& neighbor : point->neighbors.kept()) {
      Vec3 position;
      std::memcpy(&position, stage_.neighbor_position.in(*neighbor.point), sizeof position);
      near_.add(position, *neighbor.point);
      near_.add_values(*neighbor.point, stage_.reads_neighbors);
    }
    begin_.push_back(static_cast<std::uint32_t>(near_.row.size()));
  }
}

/// Slot s holds the gathered neighbours from s * kCellCapacity on, so a neighbour's reference is its number.
void OperatorCall::lay_out_slots() {
  const std::size_t attributes = stage_.reads_neighbors.size(), count = near_.row.size();
  while (refs_.size() < count) refs_.push_back(static_cast<NeighborRef>(refs_.size()));
  const std::size_t slots = (count + kCellCapacity - 1) / kCellCapacity;
  pointers_.resize(slots * attributes);
  slots_.clear();
  for (std::size_t s = 0; s < slots; ++s) {
    const std::size_t first = s * kCellCapacity;
    const std::byte** columns = pointers_.data() + s * attributes;
    for (std::size_t a = 0; a < attributes; ++a)
      columns[a] = near_.values[a].data() + first * stage_.reads_neighbors[a].bytes;
    slots_.push_back({&near_.x[first], &near_.y[first], &near_.z[first], &near_.row[first], columns});
  }
}

void OperatorCall::apply_gathered(std::span<StreamPoint* const> points) {
  std::vector<const std::byte*> reads;
  for (const auto& column : own_.values) reads.push_back(column.data());
  std::vector<std::vector<std::byte>> made;
  std::vector<std::byte*> makes;
  for (const Field& field : stage_.makes) made.emplace_back(points.size() * field.bytes);
  for (auto& column : made) makes.push_back(column.data());
  const std::vector<std::uint16_t> own = numbers(stage_.reads.size()), near = numbers(stage_.reads_neighbors.size());
  const Neighborhoods in({own_.x.data(), own_.y.data(), own_.z.data(), own_.row.data(), reads.data()}, points.size(),
                         slots_.data(), begin_.data(), refs_.data(), own, near, -1, stage_.moved);
  DegeneratePoints degenerate;
  Columns out(makes, points.size(), degenerate);
  refused_.note_from([&] { pointsweep::apply(stage_.op, in, out); });
  degenerate.for_each([&](std::size_t i) { degenerate_.add(own_.row[i]); });
  for (std::size_t m = 0; m < made.size(); ++m) {
    const std::size_t bytes = stage_.makes[m].bytes;
    for (std::size_t i = 0; i < points.size(); ++i)
      std::memcpy(stage_.makes[m].in(*points[i]), made[m].data() + i * bytes, bytes);
  }
}

void ThroughBuffer::pull_push() {
  pulled_.clear();
  while (StreamPoint* point = prev_->front()) {
    prev_->pop_front();
    pulled_.push_back(point);
  }
  call_.apply(pulled_);
  fifo_.insert(fifo_.end(), pulled_.begin(), pulled_.end());
}

void PreBuffer::pull_push() {
  while (StreamPoint* point = prev_->front()) {
    prev_->pop_front();
    references_.push(*point);
    call_.copy_fields(*point);
    fifo1_.push_back(point);
  }
  ready_.clear();
  for (; !fifo1_.empty() && may_be_processed(*fifo1_.front()); fifo1_.pop_front()) ready_.push_back(fifo1_.front());
  call_.apply(ready_);
  fifo2_.insert(fifo2_.end(), ready_.begin(), ready_.end());
}

std::uint64_t PreBuffer::smallest_element() {
  if (!fifo2_.empty()) return fifo2_.front()->index;
  if (!fifo1_.empty()) return fifo1_.front()->index;
  return prev_->smallest_element();
}

/// The paper's outline drops references when a point is released, and keeps the references of the last point (Figure
/// 15). Here references are dropped when this function reads them, so that none remain at the end of the stream.
std::uint64_t PreBuffer::smallest_reference() {
  return std::min(prev_->smallest_reference(), references_.smallest(smallest_element()));
}

}  // namespace pointsweep::reference
