// SPDX-License-Identifier: MIT
#include "pointsweep/reader.h"

#include <cassert>

namespace pointsweep {

Chunk Reader::chunk_of(std::uint64_t) const { return {.rows = info_.count, .bounds = info_.bounds}; }

std::unique_ptr<RowDecoder> Reader::decoder(const WantedFields&) const { return nullptr; }

std::size_t Reader::read(std::uint64_t row, std::span<std::byte> records) {
  if (row >= info_.count) return 0;
  if (!own_decoder_) own_decoder_ = decoder();
  assert(own_decoder_ && "a reader has decoders or reads rows itself");
  const std::size_t rows = own_decoder_->read(row, records);
  // The buffers of a decoder are not needed after the last row, as when the next of many files is read.
  if (row + rows == info_.count) own_decoder_.reset();
  return rows;
}

}  // namespace pointsweep
