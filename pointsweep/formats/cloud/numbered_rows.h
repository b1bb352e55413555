// SPDX-License-Identifier: MIT
/// A reader that adds the number of the row to each record.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "pointsweep/reader.h"

namespace pointsweep {

/// The records of `all`, each with the field kInputRow (input_row.h) at its end: the number of the row, counted from
/// `first_row` on.
class NumberedRows final : public Reader {
 public:
  NumberedRows(std::shared_ptr<Reader> all, std::uint64_t first_row);

  Chunk chunk_of(std::uint64_t row) const override { return all_->chunk_of(row); }
  bool has_decoders() const override { return all_->has_decoders(); }
  bool decodes_any_range() const override { return all_->decodes_any_range(); }
  std::unique_ptr<RowDecoder> decoder(const WantedFields& wanted) const override;
  std::size_t read(std::uint64_t row, std::span<std::byte> records) override;
  void rest() override { all_->rest(); }

 private:
  class Decoder;
  template <class Read>
  std::size_t read_numbered(Read read, std::uint64_t row, std::span<std::byte> records) const;

  std::shared_ptr<Reader> all_;
  std::uint64_t first_row_;
};

/// Throws Error if the file of the reader has an attribute that is called kInputRow.
void require_unnumbered(const Reader& reader);

}  // namespace pointsweep
