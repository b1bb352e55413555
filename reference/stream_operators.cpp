// SPDX-License-Identifier: MIT
#include "reference/stream_operators.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>

#include "pointsweep/cancellation.h"
#include "pointsweep/order/canonical_order.h"
#include "pointsweep/order/working_record.h"

namespace pointsweep::reference {
namespace {

[[maybe_unused]] bool ascend(const std::vector<Slab>& slabs, int axis) {
  for (std::size_t s = 1; s < slabs.size(); ++s)
    if (slabs[s].box.lo[axis] < slabs[s - 1].box.hi[axis]) return false;
  return true;
}

}  // namespace

void SortedSlab::load(const Stream& stream, std::size_t slab) {
  const Schema& schema = stream.record_schema();
  const std::size_t n = stream.slabs()[slab].count;
  stride_ = schema.stride;
  records_.resize(n * stride_);
  stream.read(slab, records_);
  x_.resize(n), y_.resize(n), z_.resize(n), row_.resize(n);
  decode_positions(position_fields(schema, "the working record"), records_.data(), schema.stride, n, x_.data(),
                   y_.data(), z_.data());
  for (std::size_t i = 0; i < n; ++i) row_[i] = row_of(schema, records_.data() + i * stride_);
  canonical_order(stream.axis(), x_, y_, z_, row_, order_);
}

ReadOperator::ReadOperator(const Stream& stream, const Fields& fields, Reach reach, ActiveSet& active)
    : stream_(stream), fields_(fields), reach_(reach), active_(active) {
  assert(ascend(stream.slabs(), stream.axis()) && "the search needs every unread point at the plane or behind it");
  for (const Slab& slab : stream.slabs()) total_ += slab.count;
}

void ReadOperator::pull_push() {
  if (waiting_ != nullptr || position_ == total_) return;
  for (; next_ == slab_.size(); next_ = 0) slab_.load(stream_, next_slab_++);
  waiting_ = &active_.emplace_back(slab_.position(next_), slab_.row(next_), position_++, reach_);
  fields_.fill(*waiting_, slab_.record(next_++), refused_);
}

std::uint64_t ReadOperator::smallest_element() {
  if (waiting_ != nullptr) return waiting_->index;
  return position_ < total_ ? position_ : kNoIndex;
}

void WriteOperator::pull_push() {
  while (StreamPoint* point = prev_->front()) {
    prev_->pop_front();
    fifo_.push_back(point);
  }
  if (fifo_.empty()) return;
  const std::uint64_t needed = prev_->smallest_reference();
  for (; !fifo_.empty() && fifo_.front()->index < needed; ++position_) {
    assert(fifo_.front() == &active_.front() && "the active set is a queue");
    write_(*fifo_.front());
    fifo_.pop_front();
    active_.pop_front();
  }
}

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
