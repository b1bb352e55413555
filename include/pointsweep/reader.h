// SPDX-License-Identifier: MIT
/// Reading points: one interface for all formats, for arrays in memory and for formats of your own.
///
/// A reader of your own fills info_ in its constructor (path, format, schema with x, y and z, count) and overrides
/// read(), or has_decoders() and decoder() so that several threads can decode.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/crs.h"
#include "pointsweep/export.h"
#include "pointsweep/geometry.h"

namespace pointsweep {

struct LasOrigin;

/// The parts of a file other than its points, kept for a writer of the same format (LAS: header, VLRs, EVLRs;
/// PLY: comments and obj_info). A writer of another format ignores them.
struct POINTSWEEP_EXPORT FormatExtras {
  virtual ~FormatExtras() = default;
  /// Returns the name of the format, e.g. "las". Each name belongs to one class.
  virtual std::string_view format() const = 0;
  /// Returns whether a writer would treat these extras like `other`, so that it needs only one of them. Both come from
  /// inputs after the first, in the same format.
  virtual bool is_like(const FormatExtras& other) const { return this == &other; }
};

/// Statements of a header about the points. They may be wrong.
struct HeaderClaims {
  Box bounds;                               ///< stated bounds, whose ends may be in any order, or NaN
  std::vector<std::uint64_t> returns = {};  ///< numbers of points with return number 1, 2, ...; empty if not stated
};

/// The facts known about an open input.
struct FileInfo {
  std::filesystem::path path;  ///< path for messages; any name for an input that is not a file
  std::string format;          ///< format for messages: "PLY 1.0 binary_little_endian", "LAS 1.4 point format 7"
  Schema schema;
  std::uint64_t count = 0;          ///< number of points that read() returns, even if the header states another number
  std::uint64_t left_out = 0;       ///< number of points of the file that `count` excludes and read() skips
  std::uint64_t bytes = 0;          ///< size of the file in bytes
  bool decode_once = false;         ///< true if decoding takes much longer than writing and reading the records
  std::uint64_t decoder_bytes = 0;  ///< memory that one decoding thread takes, in bytes, without the records
  std::optional<Box> bounds;        ///< bounds in the header; they may be wrong
  std::optional<double> root_spacing;  ///< spacing of the points of depth 0, if chunks are nodes of levels of detail
  std::optional<HeaderClaims> claims;  ///< set if the header states more about the points than their number
  bool z_is_up = false;                ///< true if z is the height in this format
  std::vector<std::string> warnings;   ///< sentences about harmless faults of the file
  std::shared_ptr<const FormatExtras> extras;
  std::optional<Crs> crs;                ///< the coordinate reference system, if the file states one
  std::shared_ptr<const LasOrigin> las;  ///< set if the file is LAS, or was made from LAS; for LAS writers
  std::vector<std::string> provenance;   ///< lines that say how the file was made; may be empty
  std::string asked_for_as;  ///< value of `format` in open_reader() that applied; empty for a file with a signature
};

/// Rows of a file that can be decoded without the rows before them.
struct Chunk {
  std::uint64_t first_row = 0, rows = 0;
  std::uint64_t begin = 0, end = 0;  ///< range of its bytes in the file; 0 and 0 if they are scattered or unknown
  std::optional<Box> bounds;         ///< bounds that the file states for its points; they may be wrong
  std::optional<int> depth = {};     ///< depth of the node of the octree, if chunks are nodes of levels of detail

  std::uint64_t end_row() const { return first_row + rows; }
};

/// Decodes rows of one file for one thread. It must not outlive its reader.
class POINTSWEEP_EXPORT RowDecoder {
 public:
  virtual ~RowDecoder() = default;

  /// Decodes the records `row`, `row+1`, ... into `records` (as many whole records as fit, fewer only at the end of the
  /// file) and returns their number. A call that continues the previous one decodes only its own rows; a jump also
  /// decodes the rows of the chunk before `row`, unless Reader::decodes_any_range(). Throws Error if reading fails or
  /// the file has changed.
  virtual std::size_t read(std::uint64_t row, std::span<std::byte> records) = 0;
};

/// Indices of fields of a schema; empty for all fields.
using WantedFields = std::vector<std::size_t>;

/// An input that returns points by rows, from row 0 on.
class POINTSWEEP_EXPORT Reader {
 public:
  Reader() = default;
  /// Copies the facts about the input, but not the decoder: each reader makes its own decoder for read().
  Reader(const Reader& other) : info_(other.info_) {}
  Reader& operator=(const Reader& other) {
    info_ = other.info_;
    own_decoder_.reset();
    return *this;
  }
  virtual ~Reader() = default;
  const FileInfo& info() const { return info_; }

  /// Returns the chunk that contains `row` < info().count. Thread-safe. By default all rows are one chunk.
  virtual Chunk chunk_of(std::uint64_t row) const;
  /// Returns whether decoder() returns decoders. If not, only read() reads rows, on one thread at a time. Thread-safe.
  virtual bool has_decoders() const { return false; }
  /// Returns whether any range of rows can be decoded without other rows, e.g. because all records have one size.
  /// Thread-safe.
  virtual bool decodes_any_range() const { return false; }
  /// Returns a decoder for one thread; null if not has_decoders(). Other threads may decode at the same time. In its
  /// records, only the `wanted` fields have values; the bytes of other fields are unspecified. Thread-safe.
  virtual std::unique_ptr<RowDecoder> decoder(const WantedFields& wanted = {}) const;

  /// Reads records as RowDecoder::read does, through the reader's own decoder. Not thread-safe.
  virtual std::size_t read(std::uint64_t row, std::span<std::byte> records);
  /// Frees the data that read() keeps for its next call. Called when another reader is read next.
  virtual void rest() { own_decoder_.reset(); }

 protected:
  /// Returns the number of records that a read() at `row` into `records` gives.
  std::size_t rows_for(std::uint64_t row, std::span<std::byte> records) const {
    const std::uint64_t left = row < info_.count ? info_.count - row : 0;
    return static_cast<std::size_t>(std::min<std::uint64_t>(left, records.size() / info_.schema.stride));
  }

  FileInfo info_;

 private:
  std::unique_ptr<RowDecoder> own_decoder_;  ///< decoder of read(), between the first row and the last
};

/// Opens a point file, whose content decides its format. `format` is empty or one of these:
/// - a format without a signature ("kitti", "float32-xyz"), unless the extension of the file belongs to another format;
/// - chosen levels of detail (bytes of other levels are not read): "depth:3" for the depths 0 to 3, "spacing:0.5" for
///   all depths up to the first with this spacing or less. Throws Error for a file without levels;
/// - the columns of a text file, which replace its header: "text:x,y,z,-,intensity", with "-" for columns to skip.
/// Throws Error if the file cannot be opened, UsageError for an unknown `format`.
POINTSWEEP_EXPORT std::unique_ptr<Reader> open_reader(const std::filesystem::path& path, std::string_view format = "");

/// Points from arrays, which are borrowed and must outlive the reader.
class POINTSWEEP_EXPORT ArrayReader final : public Reader {
 public:
  /// `xyz`: N×3 values, x, y and z of a point side by side. Throws UsageError if the size is not a multiple of 3.
  explicit ArrayReader(std::span<const float> xyz);
  explicit ArrayReader(std::span<const double> xyz);

  /// Adds fields with these names, e.g. {"nx", "ny", "nz"}: N×names.size() values, the values of a point side by side.
  /// Throws UsageError for another number of values.
  void add(const std::vector<std::string>& names, std::span<const float> values);
  void add(const std::vector<std::string>& names, std::span<const double> values);

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override;

 private:
  struct Column {
    const std::byte* values;
    std::size_t bytes;  ///< bytes of the values of one point
  };
  void add_column(const std::vector<std::string>& names, Type type, std::span<const std::byte> values);

  std::vector<Column> columns_;
};

}  // namespace pointsweep
