// SPDX-License-Identifier: MIT
/// Working records of the stream: the position of a point, the fields that the operators need, and its input row.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "pointsweep/points/record_map.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Makes working records from source records: copies fields of a source record, then adds its row.
class WorkingRecord {
 public:
  /// Working records have the position and the fields `payload`, or every byte of a record if `whole`. All rows are
  /// below `rows`, which decides the type of the row field.
  WorkingRecord(const Schema& source, bool whole, std::span<const std::size_t> payload, std::uint64_t rows);
  /// Makes an object that copies whole records, which are working records already.
  explicit WorkingRecord(const Schema& working);

  /// Returns the schema: fields of the source (with names, types, scales), then "row".
  const Schema& schema() const { return schema_; }

  /// Makes `count` working records. The record of row first_row + i becomes number place[i] in `to`.
  void scatter(const std::byte* from, std::size_t from_stride, std::size_t count, std::uint64_t first_row,
               const std::uint32_t* place, std::byte* to) const;

 private:
  void add_row(std::uint64_t rows);

  Schema schema_;
  RecordMap carried_;
  bool makes_row_ = false;
};

/// Returns the input row of a working record of the schema `working`.
std::uint64_t row_of(const Schema& working, const std::byte* record);

}  // namespace pointsweep
