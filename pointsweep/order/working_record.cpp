// SPDX-License-Identifier: MIT
#include "pointsweep/order/working_record.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

template <class Row>
void scatter_rows(std::uint64_t first_row, const std::uint32_t* place, std::size_t count, std::byte* to,
                  std::size_t stride) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = static_cast<Row>(first_row + i);
    std::memcpy(to + place[i] * stride, &row, sizeof(Row));
  }
}

}  // namespace

WorkingRecord::WorkingRecord(const Schema& source, bool whole, std::span<const std::size_t> payload,
                             std::uint64_t rows) {
  if (whole) {
    schema_ = source;
    carried_.add(0, 0, source.stride);
  } else {
    position_fields(source, "the input");  // throws if there is no position
    const std::size_t xyz[] = {*source.find("x"), *source.find("y"), *source.find("z")};
    for (const std::size_t field : xyz) carried_.append(source.fields[field], schema_);
    for (const std::size_t field : payload)
      if (std::ranges::find(xyz, field) == std::end(xyz)) carried_.append(source.fields[field], schema_);
  }
  add_row(rows);
}

WorkingRecord::WorkingRecord(const Schema& working) : schema_(working) { carried_.add(0, 0, working.stride); }

void WorkingRecord::add_row(std::uint64_t rows) {
  schema_.append("row", rows <= std::numeric_limits<std::uint32_t>::max() ? Type::u32 : Type::u64);
  makes_row_ = true;
}

void WorkingRecord::scatter(const std::byte* from, std::size_t from_stride, std::size_t count, std::uint64_t first_row,
                            const std::uint32_t* place, std::byte* to) const {
  const std::size_t stride = schema_.stride;
  carried_.scatter(from, from_stride, to, stride, place, count);
  if (!makes_row_) return;
  const Field& row = schema_.fields.back();
  if (row.type == Type::u32)
    scatter_rows<std::uint32_t>(first_row, place, count, to + row.offset, stride);
  else
    scatter_rows<std::uint64_t>(first_row, place, count, to + row.offset, stride);
}

std::uint64_t row_of(const Schema& working, const std::byte* record) {
  const Field& field = working.fields.back();
  if (field.type == Type::u64) {
    std::uint64_t row = 0;
    std::memcpy(&row, record + field.offset, sizeof row);
    return row;
  }
  std::uint32_t row = 0;
  std::memcpy(&row, record + field.offset, sizeof row);
  return row;
}

}  // namespace pointsweep
