// SPDX-License-Identifier: MIT
/// The compressed points of a LAZ file: its chunks, and their records.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/formats/files/input_file.h"
#include "pointsweep/formats/las/laz_layout.h"

namespace pointsweep {

/// Reads rows of records as LAS stores them. Chunks that are wholly asked for are decoded at the same time, by all
/// threads; a chunk that is read piece by piece is decoded once as long as the pieces follow each other.
class LazPoints {
 public:
  /// `begin`: the byte where the compressed data begin; `count` records of `record_bytes`. Throws Error if the VLR or
  /// the chunk table contradicts this or the file.
  LazPoints(std::shared_ptr<const InputFile> file, std::span<const std::byte> vlr, std::uint64_t begin,
            std::uint64_t count, std::uint32_t record_bytes);
  ~LazPoints();

  /// Whole records from `row` on; all must exist. Not thread-safe. Throws Error.
  void read(std::uint64_t row, std::span<std::byte> records);
  /// Forgets the chunk that was last read to its middle, and frees its memory.
  void rest();

  std::size_t chunks() const { return first_row_.size() - 1; }

 private:
  class Decoder;
  struct Piece {
    std::size_t chunk;
    std::uint64_t first, rows;  ///< in the chunk
    std::byte* records;
  };

  void read_chunk_table(std::uint64_t begin, std::uint64_t count);
  std::vector<Piece> pieces(std::uint64_t row, std::span<std::byte> records) const;

  std::shared_ptr<const InputFile> file_;
  LazLayout layout_;
  std::uint32_t record_bytes_;
  std::vector<std::uint64_t> first_row_, first_byte_;  ///< by chunk, and one more for the end
  std::unique_ptr<Decoder> open_;                      ///< of the chunk that was last read to its middle
};

}  // namespace pointsweep
