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
/// PLY: comments and obj_info). A writer of another format ignores it.
struct POINTSWEEP_EXPORT FormatExtras {
  virtual ~FormatExtras() = default;
  /// Returns the name of the format, "las". Each name belongs to one class.
  virtual std::string_view format() const = 0;
  /// Returns whether the extras mean the same for a writer as `other`. Both belong to inputs of this format after the
  /// first. A writer gets only one of several such extras.
  virtual bool is_like(const FormatExtras& other) const { return this == &other; }
};

/// Statements of a header about the points. They may be wrong.
struct HeaderClaims {
  Box bounds;                               ///< the ends may be in any order, or NaN
  std::vector<std::uint64_t> returns = {};  ///< number of points of return number 1, 2, ...; empty: not stated
};

/// The facts known about an open input.
struct FileInfo {
  std::filesystem::path path;  ///< for messages; any name if there is no file
  std::string format;          ///< for messages: "PLY 1.0 binary_little_endian", "LAS 1.4 point format 7"
  Schema schema;
  std::uint64_t count = 0;             ///< points in the file, even if its header states another number
  std::uint64_t left_out = 0;          ///< points of the file that `count` excludes and read() skips
  std::uint64_t bytes = 0;             ///< size of the file
  bool decode_once = false;            ///< decoding costs much more than writing and reading its records
  std::uint64_t decoder_bytes = 0;     ///< memory of each decoding thread, besides the records
  std::optional<Box> bounds;           ///< bounds in the header; they may be wrong
  std::optional<double> root_spacing;  ///< spacing of the points of depth 0, if chunks are nodes of levels of detail
  std::optional<HeaderClaims> claims;  ///< set if the header states more about the points than their number
  bool z_is_up = false;                ///< the format says that z is the height
  std::vector<std::string> warnings;   ///< harmless faults, one sentence each
  std::shared_ptr<const FormatExtras> extras;
  std::optional<Crs> crs;                ///< the coordinate reference system, if the file states one
  std::shared_ptr<const LasOrigin> las;  ///< set if the file is LAS, or was made from LAS; for LAS writers
  std::vector<std::string> provenance;   ///< lines that say how the file was made; may be empty
  std::string asked_for_as;  ///< the `format` of open_reader() that matches the file; empty if it has a signature
};

/// Rows of a file that can be decoded without the rows before them.
struct Chunk {
  std::uint64_t first_row = 0, rows = 0;
  std::uint64_t begin = 0, end = 0;  ///< its bytes in the file; 0 and 0 if they are scattered or unknown
  std::optional<Box> bounds;         ///< bounds of its points in the file; they may be wrong
  std::optional<int> depth = {};     ///< depth of its node, if chunks are nodes of levels of detail

  std::uint64_t end_row() const { return first_row + rows; }
};

/// Decodes rows of one file for one thread. It must not outlive its reader.
class POINTSWEEP_EXPORT RowDecoder {
 public:
  virtual ~RowDecoder() = default;

  /// Decodes the records `row`, `row+1`, ... into `records` (as many whole records as fit, fewer only at the end of the
  /// file) and returns their number. A call that continues the previous one decodes only its own rows; a jump also
  /// decodes the rows of the chunk before `row`. Throws Error if reading fails or the file has changed.
  virtual std::size_t read(std::uint64_t row, std::span<std::byte> records) = 0;
};

/// Indices of fields of a schema. Empty: all fields.
using WantedFields = std::vector<std::size_t>;

/// An input that returns points by rows, from row 0 on.
class POINTSWEEP_EXPORT Reader {
 public:
  Reader() = default;
  /// Copies the facts, not the decoder: each reader makes its own decoder for read().
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
  /// Returns whether any range of rows is a chunk, as where all records have one size. Thread-safe.
  virtual bool decodes_any_range() const { return false; }
  /// Returns a decoder for one thread; other threads may decode at the same time. Thread-safe. In its records only the
  /// `wanted` fields have their values; the bytes of the others are unspecified. Null if not has_decoders().
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

/// Opens a point file. Its content tells the format. `format` names a format without a signature ("kitti",
/// "float32-xyz"), which applies unless the extension of the file belongs to another format. "depth:3" and
/// "spacing:0.5" choose levels of detail: depths 0 to 3, or all depths up to the first with this spacing or less; only
/// their bytes are read. Throws Error for a file without levels. "text:x,y,z,-,intensity" names the columns of a text
/// file, "-" for those to skip, and replaces its header. Throws Error if the file cannot be opened, UsageError for an
/// unknown `format`.
POINTSWEEP_EXPORT std::unique_ptr<Reader> open_reader(const std::filesystem::path& path, std::string_view format = "");

/// Points from arrays, which are borrowed and must outlive the reader.
class POINTSWEEP_EXPORT ArrayReader final : public Reader {
 public:
  /// `xyz`: N×3, x y z of one point side by side. Throws UsageError if its size is no multiple of 3.
  explicit ArrayReader(std::span<const float> xyz);
  explicit ArrayReader(std::span<const double> xyz);

  /// Adds an attribute: N×names.size() values, those of one point side by side, e.g. {"nx", "ny", "nz"}.
  void add(const std::vector<std::string>& names, std::span<const float> values);
  void add(const std::vector<std::string>& names, std::span<const double> values);

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override;

 private:
  struct Column {
    const std::byte* values;
    std::size_t bytes;  ///< bytes per point
  };
  void add_column(const std::vector<std::string>& names, Type type, std::span<const std::byte> values);

  std::vector<Column> columns_;
};

}  // namespace pointsweep
