// SPDX-License-Identifier: MIT
/// A reader that another object owns.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "pointsweep/reader.h"

namespace pointsweep {

/// Reads the rows of `reader`, for a second cloud of the same file. `reader` must outlive it. Only one thread at a time
/// may call read() of either.
class BorrowedReader final : public Reader {
 public:
  explicit BorrowedReader(Reader& reader) : reader_(reader) { info_ = reader.info(); }

  Chunk chunk_of(std::uint64_t row) const override { return reader_.chunk_of(row); }
  bool has_decoders() const override { return reader_.has_decoders(); }
  bool decodes_any_range() const override { return reader_.decodes_any_range(); }
  std::unique_ptr<RowDecoder> decoder(const WantedFields& wanted) const override { return reader_.decoder(wanted); }
  std::size_t read(std::uint64_t row, std::span<std::byte> records) override { return reader_.read(row, records); }
  void rest() override { reader_.rest(); }

 private:
  Reader& reader_;
};

}  // namespace pointsweep
