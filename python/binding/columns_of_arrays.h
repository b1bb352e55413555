// SPDX-License-Identifier: MIT
/// A cloud whose attributes are arrays of Python.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pointsweep/reader.h"
#include "python/binding/array_columns.h"

namespace pointsweep {

/// The name of the field that holds the number of each row.
inline constexpr const char* kRowField = "row";

/// Reads arrays as points. Rows may be split anywhere and are decoded by all threads. Arrays are not copied: they may
/// be strided or memory-mapped.
class ColumnsOfArrays final : public Reader {
 public:
  /// `with_rows`: true to add the field kRowField, i64. Throws UsageError if the arrays differ in length.
  ColumnsOfArrays(std::vector<ArrayColumn> columns, bool with_rows, std::optional<Crs> crs);

  Chunk chunk_of(std::uint64_t row) const override;
  bool has_decoders() const override { return true; }
  bool decodes_any_range() const override { return true; }
  std::unique_ptr<RowDecoder> decoder(const WantedFields& wanted = {}) const override;

 private:
  class Decoder;
  /// Bytes of a row that are contiguous in an array and in a record.
  struct Piece {
    const std::byte* first;  ///< address of row 0; null: the value is the number of the row
    std::ptrdiff_t stride;
    std::uint32_t offset, bytes;  ///< place in a record
  };

  void add(const ArrayColumn& column);

  std::vector<ArrayColumn> columns_;  ///< held to keep the arrays alive
  std::vector<Piece> pieces_;
};

}  // namespace pointsweep
