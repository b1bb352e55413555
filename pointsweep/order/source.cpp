// SPDX-License-Identifier: MIT
#include "pointsweep/order/source.h"

#include <algorithm>

#include "pointsweep/fail.h"

namespace pointsweep {

void read_fully(const PointSource& source, std::uint64_t row, std::span<std::byte> records) {
  read_fully(source, source.read, row, records);
}

void read_fully(const PointSource& source, const ReadRows& read, std::uint64_t row, std::span<std::byte> records) {
  while (!records.empty()) {
    const std::size_t got = read(row, records);
    if (got == 0)
      fail(
          "the input ends at point {} though it holds {}: it was cut short while it was read; run again on the "
          "complete input.",
          row, source.count);
    row += got;
    records = records.subspan(got * source.schema.stride);
  }
}

std::vector<std::size_t> position_columns(const Schema& schema) {
  std::vector<std::size_t> columns;
  for (const char* axis : {"x", "y", "z"})
    if (const auto field = schema.find(axis)) columns.push_back(*field);
  return columns;
}

BlockReader::BlockReader(const PointSource& source, const std::vector<std::size_t>& wanted)
    : source_(source), fields_(position_fields(source.schema, "the input")), read_(source.for_thread(wanted)) {}

void BlockReader::read(std::uint64_t first_row, std::size_t rows) {
  const std::size_t stride = source_.schema.stride;
  count_ = rows;
  records_.resize(std::max(records_.size(), rows * stride));
  numbers_.resize(std::max(numbers_.size(), 3 * rows));
  read_fully(source_, read_, first_row, std::span(records_).first(rows * stride));
  double* const x = numbers_.data();
  decode_positions(fields_, records_.data(), stride, rows, x, x + rows, x + 2 * rows);
}

}  // namespace pointsweep
