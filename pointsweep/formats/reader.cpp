// SPDX-License-Identifier: MIT
#include "pointsweep/reader.h"

#include <cassert>
#include <stdexcept>

#include "pointsweep/writer.h"

namespace pointsweep {

Chunk Reader::chunk_of(std::uint64_t) const { return {.rows = info_.count, .bounds = info_.bounds}; }

std::unique_ptr<RowDecoder> Reader::decoder(const WantedFields&) const { return nullptr; }

std::size_t Reader::read(std::uint64_t row, std::span<std::byte> records) {
  if (row >= info_.count) return 0;
  if (!own_decoder_) own_decoder_ = decoder();
  assert(own_decoder_ && "a reader has decoders or reads rows itself");
  const std::size_t rows = own_decoder_->read(row, records);
  // The buffers of a decoder are not needed after the last row, for example when the next of many files is read.
  if (row + rows == info_.count) own_decoder_.reset();
  return rows;
}

void Writer::write_at(std::uint64_t, std::span<const std::byte>) {
  throw std::logic_error("write_at() was called on a writer whose can_write_at() is false");
}

}  // namespace pointsweep
