// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/slab_order.h"

#include <cstring>

#include "pointsweep/order/canonical_order.h"

namespace pointsweep {

std::vector<std::uint32_t> order_of(const Stream& stream, const std::vector<std::byte>& records) {
  const Schema& schema = stream.record_schema();
  const std::size_t n = records.size() / schema.stride;
  std::vector<double> x(n), y(n), z(n);
  std::vector<std::uint64_t> row(n);
  decode_positions(position_fields(schema, "the working record"), records.data(), schema.stride, n, x.data(), y.data(),
                   z.data());
  const Field& field = schema.fields.back();
  for (std::size_t i = 0; i < n; ++i) {
    std::memcpy(&row[i], records.data() + i * schema.stride + field.offset, size_of(field.type));  // zero above a u32
  }
  std::vector<std::uint32_t> order;
  canonical_order(stream.axis(), x, y, z, row, order);
  return order;
}

std::vector<std::uint32_t> ranks(const Stream& stream, const std::vector<std::byte>& records) {
  const std::vector<std::uint32_t> order = order_of(stream, records);
  std::vector<std::uint32_t> rank(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) rank[order[i]] = i;
  return rank;
}

}  // namespace pointsweep
