// SPDX-License-Identifier: MIT
#include "reference/sorted_slab.h"

#include "pointsweep/order/canonical_order.h"
#include "pointsweep/order/working_record.h"

namespace pointsweep::reference {

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

}  // namespace pointsweep::reference
