// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/rows/nonfinite_points.h"

#include <algorithm>

#include "pointsweep/order/working_record.h"

namespace pointsweep {

void for_each_nonfinite(const Stream& stream,
                        const std::function<void(std::uint64_t first, std::span<const std::byte> records)>& use) {
  const std::uint64_t n = stream.nonfinite_count(), chunk = 65536;
  std::vector<std::byte> records;
  for (std::uint64_t first = 0; first < n; first += chunk) {
    records.resize(std::min(chunk, n - first) * stream.record_schema().stride);
    stream.read_nonfinite(first, records);
    use(first, records);
  }
}

std::vector<std::uint64_t> rows_of_records(const Stream& stream, std::span<const std::byte> records) {
  const Schema& schema = stream.record_schema();
  std::vector<std::uint64_t> rows;
  for (std::size_t at = 0; at < records.size(); at += schema.stride)
    rows.push_back(row_of(schema, records.data() + at));
  return rows;
}

std::vector<std::uint64_t> first_nonfinite_rows(const Stream& stream, std::size_t most) {
  const std::uint64_t n = std::min<std::uint64_t>(most, stream.nonfinite_count());
  std::vector<std::byte> records(n * stream.record_schema().stride);
  stream.read_nonfinite(0, records);
  return rows_of_records(stream, records);
}

}  // namespace pointsweep
