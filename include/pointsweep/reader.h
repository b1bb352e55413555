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
  /// The name of the format, "las". One name stands for one class.
  virtual std::string_view format() const = 0;
  /// Returns whether these extras of an input after the first tell a writer the same as `other`, those of another such
  /// input of this format: then it gets only one of both.
  virtual bool is_like(const FormatExtras& other) const { return this == &other; }
};

/// Statements of a header about the points, as the file has them. They may be wrong.
struct HeaderClaims {
  Box bounds;                               ///< the ends may be in any order, or NaN
  std::vector<std::uint64_t> returns = {};  ///< points of return number 1, 2, ...; empty: it does not count them
};

/// The facts that are known of an input when it is open.
struct FileInfo {
  std::filesystem::path path;  ///< for messages; of what is no file, any name
  std::string format;          ///< for people: "PLY 1.0 binary_little_endian", "LAS 1.4 point format 7"
  Schema schema;
  std::uint64_t count = 0;             ///< points really in the file, never merely what a header claims
  std::uint64_t left_out = 0;          ///< points of the file that `count` and read() leave out
  std::uint64_t bytes = 0;             ///< size of the file
  bool decode_once = false;            ///< decoding costs much more than writing and reading its records
  std::uint64_t decoder_bytes = 0;     ///< what each thread takes that decodes it, in addition to the records
  std::optional<Box> bounds;           ///< as a header states them: a hint, not to be trusted
  std::optional<double> root_spacing;  ///< of the points of depth 0, where chunks are nodes of levels of detail
  std::optional<HeaderClaims> claims;  ///< of a header that says more of the points than their number
  bool z_is_up = false;                ///< the format says that z is the height
  std::vector<std::string> warnings;   ///< what was wrong but harmless, one sentence each
  std::shared_ptr<const FormatExtras> extras;
  std::optional<Crs> crs;                ///< the coordinate reference system, if the file states one
  std::shared_ptr<const LasOrigin> las;  ///< if the file is LAS, or its points once were; for LAS writers
  std::vector<std::string> provenance;   ///< lines that say how the file was made; may be empty
  std::string asked_for_as;  ///< the `format` of open_reader() that the file has; empty if it has a signature
};

/// Rows of a file that can be decoded without the rows before them.
struct Chunk {
  std::uint64_t first_row = 0, rows = 0;
  std::uint64_t begin = 0, end = 0;  ///< its bytes in the file; 0 and 0 where they are in several places or unknown
  std::optional<Box> bounds;         ///< of its points, as the file states it: a hint, not to be trusted
  std::optional<int> depth = {};     ///< of its node, where chunks are nodes of levels of detail

  std::uint64_t end_row() const { return first_row + rows; }
};

/// Decodes rows of one file for one thread. It must not outlive its reader.
class POINTSWEEP_EXPORT RowDecoder {
 public:
  virtual ~RowDecoder() = default;

  /// Decodes the records `row`, `row+1`, ... into `records` (as many whole records as fit, fewer only at the end of the
  /// file) and returns how many. A call that continues the one before costs nothing more than its own rows; a jump
  /// decodes the rows of the chunk that are before `row`. Throws Error when the file fails or has changed.
  virtual std::size_t read(std::uint64_t row, std::span<std::byte> records) = 0;
};

/// Fields of a schema by index. Empty: all of them.
using WantedFields = std::vector<std::size_t>;

/// Gives the points of one input by rows, from row 0 on.
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

  /// The chunk that holds `row` < info().count. Thread-safe. By default all rows are one chunk.
  virtual Chunk chunk_of(std::uint64_t row) const;
  /// Returns whether decoder() gives decoders. If not, one thread at a time reads rows by read(). Thread-safe.
  virtual bool has_decoders() const { return false; }
  /// Returns whether any range of rows is a chunk, as where all records have one size. Thread-safe.
  virtual bool decodes_any_range() const { return false; }
  /// A decoder for one thread, beside which others may decode. Thread-safe. Only the `wanted` fields of its records are
  /// sure to have their values; the bytes of the others are unspecified. Null without has_decoders().
  virtual std::unique_ptr<RowDecoder> decoder(const WantedFields& wanted = {}) const;

  /// Reads records as RowDecoder::read does, through the reader's own decoder. Not thread-safe.
  virtual std::size_t read(std::uint64_t row, std::span<std::byte> records);
  /// Frees what read() keeps for the next call, since another reader is read now.
  virtual void rest() { own_decoder_.reset(); }

 protected:
  /// Returns the number of records that a read() at `row` into `records` gives.
  std::size_t rows_for(std::uint64_t row, std::span<std::byte> records) const {
    const std::uint64_t left = row < info_.count ? info_.count - row : 0;
    return static_cast<std::size_t>(std::min<std::uint64_t>(left, records.size() / info_.schema.stride));
  }

  FileInfo info_;

 private:
  std::unique_ptr<RowDecoder> own_decoder_;  ///< of read(), between the first row and the last
};

/// Opens a point file of any known format, told by its content. `format` names one that has no signature ("kitti",
/// "float32-xyz"); it is that of the file unless the name of the file ends as those of another format.
/// "depth:3" and "spacing:0.5" choose levels of detail, those of depths 0 to 3, or of as many depths as it takes until
/// points lie no farther apart; only their bytes are read. Throws Error for a file without levels.
/// "text:x,y,z,-,intensity" names the columns of a text file, "-" for those to skip, and replaces its header. Throws
/// Error in one sentence when it cannot, UsageError for an unknown `format`.
POINTSWEEP_EXPORT std::unique_ptr<Reader> open_reader(const std::filesystem::path& path, std::string_view format = "");

/// Points from arrays, which are borrowed and must outlive the reader.
class POINTSWEEP_EXPORT ArrayReader final : public Reader {
 public:
  /// `xyz`: N×3, x y z of one point side by side. Throws UsageError if its size is no multiple of 3.
  explicit ArrayReader(std::span<const float> xyz);
  explicit ArrayReader(std::span<const double> xyz);

  /// One more attribute: N×names.size() values, those of one point side by side, e.g. {"nx", "ny", "nz"}.
  void add(const std::vector<std::string>& names, std::span<const float> values);
  void add(const std::vector<std::string>& names, std::span<const double> values);

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override;

 private:
  struct Column {
    const std::byte* values;
    std::size_t bytes;  ///< of one point
  };
  void add_column(const std::vector<std::string>& names, Type type, std::span<const std::byte> values);

  std::vector<Column> columns_;
};

}  // namespace pointsweep
