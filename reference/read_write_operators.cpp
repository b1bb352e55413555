// SPDX-License-Identifier: MIT
#include "reference/read_write_operators.h"

#include <cassert>

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

}  // namespace pointsweep::reference
