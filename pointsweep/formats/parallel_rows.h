// SPDX-License-Identifier: MIT
/// Rows of a cloud in sequence, decoded on all threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/formats/input_cloud.h"

namespace pointsweep {

/// Has a decoder for each thread. Each chunk is decoded by one of them, also where it is continued by the next call.
class ParallelRows {
 public:
  /// As InputCloud::read. The same cloud each time, in which no other rows are selected meanwhile.
  std::size_t read(InputCloud& cloud, std::uint64_t row, std::span<std::byte> records);

 private:
  struct Piece {
    std::uint64_t row, end;
    std::size_t decoder;
  };
  std::vector<Piece> pieces_of(const InputCloud& cloud, std::uint64_t row, std::uint64_t end);

  std::vector<std::unique_ptr<RowDecoder>> decoders_;  ///< empty: not made yet
  std::size_t next_ = 0;                               ///< decoder of the chunk at which the last call ended
};

}  // namespace pointsweep
