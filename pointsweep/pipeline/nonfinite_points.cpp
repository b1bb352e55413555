// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/nonfinite_points.h"

#include <algorithm>
#include <cstring>

#include "pointsweep/order/working_record.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

void for_each_nonfinite(const Stream& stream,
                        const std::function<void(std::uint64_t i, const std::byte* record, std::uint64_t row)>& use) {
  const Schema& schema = stream.record_schema();
  const std::uint64_t n = stream.nonfinite_count(), chunk = 65536;
  std::vector<std::byte> records;
  for (std::uint64_t first = 0; first < n; first += chunk) {
    const std::uint64_t count = std::min(chunk, n - first);
    records.resize(count * schema.stride);
    stream.read_nonfinite(first, records);
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::byte* record = records.data() + i * schema.stride;
      use(first + i, record, row_of(schema, record));
    }
  }
}

std::vector<std::uint64_t> first_nonfinite_rows(const Stream& stream, std::size_t most) {
  const Schema& schema = stream.record_schema();
  std::vector<std::byte> records(std::min<std::uint64_t>(most, stream.nonfinite_count()) * schema.stride);
  stream.read_nonfinite(0, records);
  std::vector<std::uint64_t> rows;
  for (std::size_t at = 0; at < records.size(); at += schema.stride)
    rows.push_back(row_of(schema, records.data() + at));
  return rows;
}

NonfiniteResult::NonfiniteResult(const std::vector<Attribute>& made, const Schema& working_record)
    : position_(position_fields(working_record, "the working record")) {
  for (const Attribute& a : made) {
    if (a.name == position_attribute().name || a.name == stream_position_attribute().name)
      positions_.push_back(result_.size());
    result_.insert(result_.end(), a.bytes(), a.fill);
  }
}

const std::vector<std::byte>& NonfiniteResult::of(const std::byte* record) {
  const double position[3] = {value_of(position_.x, record), value_of(position_.y, record),
                              value_of(position_.z, record)};
  for (const std::size_t at : positions_) std::memcpy(result_.data() + at, position, sizeof position);
  return result_;
}

}  // namespace pointsweep
