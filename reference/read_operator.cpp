// SPDX-License-Identifier: MIT
#include "reference/read_operator.h"

#include "pointsweep/order/canonical_order.h"
#include "pointsweep/order/working_record.h"

namespace pointsweep::reference {

ReadOperator::ReadOperator(const Stream& stream, const Fields& fields, Reach reach, ActiveSet& active)
    : stream_(stream), fields_(fields), reach_(reach), active_(active) {
  for (const Slab& slab : stream.slabs()) total_ += slab.count;
}

void ReadOperator::pull_push() {
  if (waiting_ != nullptr || position_ == total_) return;
  while (next_ == order_.size()) load_slab();
  const std::uint32_t i = order_[next_++];
  active_.emplace_back(Vec3{x_[i], y_[i], z_[i]}, row_[i], position_++, reach_);
  waiting_ = &active_.back();
  fields_.fill(*waiting_, records_.data() + std::size_t{i} * stream_.record_schema().stride);
}

void ReadOperator::load_slab() {
  const Schema& schema = stream_.record_schema();
  const std::size_t n = stream_.slabs()[next_slab_].count;
  records_.resize(n * schema.stride);
  stream_.read(next_slab_++, records_);
  x_.resize(n), y_.resize(n), z_.resize(n), row_.resize(n);
  decode_positions(position_fields(schema, "the working record"), records_.data(), schema.stride, n, x_.data(),
                   y_.data(), z_.data());
  for (std::size_t i = 0; i < n; ++i) row_[i] = row_of(schema, records_.data() + i * schema.stride);
  canonical_order(stream_.axis(), x_, y_, z_, row_, order_);
  next_ = 0;
}

std::uint64_t ReadOperator::smallest_element() {
  if (waiting_ != nullptr) return waiting_->index;
  return position_ < total_ ? position_ : kNoIndex;
}

}  // namespace pointsweep::reference
