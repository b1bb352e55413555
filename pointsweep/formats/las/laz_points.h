// SPDX-License-Identifier: MIT
/// The compressed points of a LAZ file, chunk by chunk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/formats/las/laz_layout.h"
#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {

/// Rows of records as LAS stores them. Immutable, so that each of many threads may have a Cursor.
class LazPoints {
  class Decoder;

 public:
  /// `begin`: the byte where the compressed data begin. `count`: records of `record_bytes`. Throws Error if the VLR or
  /// the chunk table contradicts these arguments or the file.
  LazPoints(std::shared_ptr<const InputFile> file, std::span<const std::byte> vlr, std::uint64_t begin,
            std::uint64_t count, std::uint32_t record_bytes);

  /// Reads rows for one thread. Chunks within one read are decoded in parallel, by all threads. A chunk that is read in
  /// successive pieces is decoded once.
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
