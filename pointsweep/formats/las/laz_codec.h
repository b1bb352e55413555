// SPDX-License-Identifier: MIT
/// The C++ side of the LASzip codec (codecs/), with errors as exceptions: the content of the LASzip VLR, the chunk
/// table, the compression of chunks, and the compressed points of a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/storage/local/input_file.h"

struct psc_laz;

namespace pointsweep {

/// User and record number of the LASzip VLR.
inline constexpr std::string_view kLaszipUser = "laszip encoded";
inline constexpr std::uint16_t kLaszipRecord = 22204;

/// Number of points in each chunk of a LAZ output, as in most programs. Chunks of COPC vary in size.
inline constexpr std::uint32_t kLazChunkPoints = 50'000;

/// Bytes before the first chunk, which store the offset of the chunk table.
inline constexpr std::uint64_t kLazOffsetBytes = 8;

/// The compression of records. Immutable, so that any number of threads may use it. Without codecs (has_codecs()),
/// parse() and for_format() throw Error.
class LazLayout {
 public:
  /// Decodes the content of the LASzip VLR. Throws Error with a message that begins with `path`.
  static LazLayout parse(std::span<const std::byte> vlr, const std::string& path);
  /// Makes a layout for writing records of a point format (0 to 10) with extra bytes; `chunk_points` may be kVariable.
  /// Throws Error for other formats.
  static LazLayout for_format(std::uint8_t point_format, std::uint16_t extra_bytes, std::uint32_t chunk_points,
                              const std::string& path);

  static constexpr std::uint32_t kVariable = 0, kNoChunks = ~std::uint32_t{0};
  /// Returns the number of points in every chunk but the last; kVariable if the chunk table states the number for each;
  /// kNoChunks if all points are in one run without a table.
  std::uint32_t chunk_points() const;
  std::uint32_t record_bytes() const;
  std::vector<std::byte> vlr() const;

  struct ChunkSize {
    std::uint64_t points, bytes;  ///< points is 0 unless chunk_points() is kVariable
  };
  /// Decodes the chunk table with which `table` begins. Throws Error unless it has `count` chunks.
  std::vector<ChunkSize> read_chunk_table(std::span<const std::byte> table, std::size_t count) const;
  std::vector<std::byte> write_chunk_table(std::span<const ChunkSize> chunks) const;

  /// Compresses one chunk of whole records, at least one. Thread-safe.
  std::vector<std::byte> compress(std::span<const std::byte> records) const;

  const psc_laz* codec() const { return codec_.get(); }
  /// Throws Error with a message that the file cannot be decompressed, and the reason.
  [[noreturn]] void fail_with(const char* reason) const;

 private:
  LazLayout(std::shared_ptr<const psc_laz> codec, std::string path)
      : codec_(std::move(codec)), path_(std::move(path)) {}

  std::shared_ptr<const psc_laz> codec_;
  std::string path_;
};

/// The compressed points of a file, read by rows as LAS records. Immutable, so that each of many threads may have a
/// Cursor.
class LazPoints {
  class Decoder;

 public:
  /// `begin`: the byte where the compressed data begin. `count`: the number of points. Throws Error if the VLR or the
  /// chunk table contradicts these arguments or the file.
  LazPoints(std::shared_ptr<const InputFile> file, std::span<const std::byte> vlr, std::uint64_t begin,
            std::uint64_t count, std::uint32_t record_bytes);

  /// Reads rows for one thread. All threads decode the chunks of one call of read() in parallel. A chunk that
  /// successive calls read in pieces is decoded once.
  class Cursor {
   public:
    /// `points` must outlive the cursor.
    explicit Cursor(const LazPoints& points);
    ~Cursor();
    /// Reads whole records from `row` on, all of which must exist. Throws Error for damaged data.
    void read(std::uint64_t row, std::span<std::byte> records);

   private:
    const LazPoints& points_;
    std::unique_ptr<Decoder> open_;  ///< decoder of a chunk that was read in part
  };

  std::size_t chunks() const { return first_row_.size() - 1; }
  std::size_t chunk_of(std::uint64_t row) const;
  /// Return the first row and the first byte of a chunk. `chunk` may be chunks(), for the end of the last chunk.
  std::uint64_t first_row(std::size_t chunk) const { return first_row_[chunk]; }
  std::uint64_t first_byte(std::size_t chunk) const { return first_byte_[chunk]; }

 private:
  struct Piece {
    std::size_t chunk;
    std::uint64_t first, rows;  ///< rows in the chunk
    std::byte* records;
  };

  void read_chunk_table(std::uint64_t begin, std::uint64_t count);
  std::vector<Piece> pieces(std::uint64_t row, std::span<std::byte> records) const;

  std::shared_ptr<const InputFile> file_;
  LazLayout layout_;
  std::uint32_t record_bytes_;
  std::vector<std::uint64_t> first_row_, first_byte_;  ///< for each chunk, and for the end of the last chunk
};

}  // namespace pointsweep
