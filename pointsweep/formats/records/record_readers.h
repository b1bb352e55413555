// SPDX-License-Identifier: MIT
/// Bases of readers: of files that store values as bytes, by column or by record, and of files with one point in each
/// line of text; and names for the fields of an array.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pointsweep/formats/files/line_reader.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/reader.h"
#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {

/// The values of one attribute, or of several adjacent ones, for all rows.
struct StoredColumn {
  std::uint64_t begin = 0;   ///< byte of row 0 in the file
  std::uint32_t bytes = 0;   ///< bytes of one row
  std::uint32_t offset = 0;  ///< offset of these bytes in a record
};

/// Reads files that store values column by column. Rows may be split anywhere. A decoder reads only the columns of the
/// wanted fields.
class ColumnsReader : public Reader {
 public:
  Chunk chunk_of(std::uint64_t row) const override;
  bool decodes_any_range() const override { return true; }
  bool has_decoders() const override { return true; }
  std::unique_ptr<RowDecoder> decoder(const WantedFields& wanted = {}) const override;

 protected:
  /// Sets the columns. info_.schema and info_.count must be set before. The caller has checked that the file has the
  /// bytes of all rows. `big_endian`: the fields with big-endian values.
  void has_columns(std::shared_ptr<const InputFile> file, std::vector<StoredColumn> columns,
                   std::vector<Field> big_endian = {});
  /// Sets the columns of a file with whole records one after another, row 0 at byte `first`.
  void has_records(std::shared_ptr<const InputFile> file, std::uint64_t first, std::vector<Field> big_endian = {}) {
    has_columns(std::move(file), {{first, info_.schema.stride, 0}}, std::move(big_endian));
  }

 private:
  class Decoder;
  /// Returns whether the column holds whole records.
  bool is_record(const StoredColumn& column) const { return column.bytes == info_.schema.stride; }

  std::shared_ptr<const InputFile> file_;
  std::vector<StoredColumn> columns_;
  std::vector<Field> big_endian_;
};

/// Appends an array with `components` values per point to `schema`, for files that name arrays but not their components
/// (VTK, NPZ). Returns the index of its first field. Three values called xyz, points, position(s), vertices or
/// coordinates become x, y, z; three floats called normal(s) nx, ny, nz; three or four unsigned bytes called color(s),
/// colour(s), rgb or rgba red, green, blue (and alpha). Any other array, and one of these if `schema` has one of the
/// names, becomes one field with all components under its own name; a repeated name gets _2, _3, ... added.
std::size_t append_array(Schema& schema, const std::string& name, Type type, std::uint32_t components);

/// Converts lines to records. All fields are parsed, even if only some are wanted, so that an invalid value ends a run
/// in its first pass over the file.
class LineParser {
 public:
  virtual ~LineParser() = default;
  /// Parses line number `number` of the file, from 1. Throws Error for a line that is not a record.
  virtual void parse(std::string_view line, std::uint64_t number, std::byte* record) = 0;
};

/// A reader whose chunks are the rows between two stored places of RowLines (line_reader.h).
class RowTextReader : public Reader {
 public:
  Chunk chunk_of(std::uint64_t row) const override;
  bool has_decoders() const override { return true; }
  std::unique_ptr<RowDecoder> decoder(const WantedFields& wanted = {}) const override;

 protected:
  /// Returns a parser for one thread.
  virtual std::unique_ptr<LineParser> parser() const = 0;

  std::unique_ptr<const InputFile> file_;
  std::optional<RowLines> rows_;

 private:
  class Decoder;
};

}  // namespace pointsweep
