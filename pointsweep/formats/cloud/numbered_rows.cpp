// SPDX-License-Identifier: MIT
#include "pointsweep/formats/cloud/numbered_rows.h"

#include <cstring>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/points/input_row.h"

namespace pointsweep {

NumberedRows::NumberedRows(std::shared_ptr<Reader> all, std::uint64_t first_row)
    : all_(std::move(all)), first_row_(first_row) {
  info_ = all_->info();
  info_.schema = with_input_row(info_.schema);
}

/// Reads the records without numbers into the end of `records`, and then moves each to its place before its number. No
/// move overwrites a record that has not been moved, since the place of a record ends before the next record begins.
template <class Read>
std::size_t NumberedRows::read_numbered(Read read, std::uint64_t row, std::span<std::byte> records) const {
  const std::size_t stride = info_.schema.stride, own = all_->info().schema.stride;
  const std::size_t most = rows_for(row, records);
  std::byte* const end = records.data() + most * (stride - own);
  const std::size_t rows = most == 0 ? 0 : read(row, std::span(end, most * own));
  for (std::size_t i = 0; i < rows; ++i) {
    std::byte* const record = records.data() + i * stride;
    std::memmove(record, end + i * own, own);
    const std::uint64_t number = first_row_ + row + i;
    std::memcpy(record + own, &number, sizeof number);
  }
  return rows;
}

class NumberedRows::Decoder final : public RowDecoder {
 public:
  Decoder(const NumberedRows& rows, std::unique_ptr<RowDecoder> own) : rows_(rows), own_(std::move(own)) {}

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    return rows_.read_numbered([this](std::uint64_t first, auto own) { return own_->read(first, own); }, row, records);
  }

 private:
  const NumberedRows& rows_;
  std::unique_ptr<RowDecoder> own_;
};

std::unique_ptr<RowDecoder> NumberedRows::decoder(const WantedFields& wanted) const {
  if (!has_decoders()) return nullptr;
  const std::size_t number = info_.schema.fields.size() - 1;
  WantedFields own = wanted;
  std::erase(own, number);
  if (own.empty() && !wanted.empty()) own = {0};  // an empty list would mean all fields
  return std::make_unique<Decoder>(*this, all_->decoder(own));
}

void require_unnumbered(const Reader& reader) {
  if (!has_input_row(reader.info().schema)) return;
  fail("{}: an attribute is called '{}', which pointsweep calls the number of the row; rename it.",
       reader.info().path.string(), kInputRow);
}

std::size_t NumberedRows::read(std::uint64_t row, std::span<std::byte> records) {
  return read_numbered([this](std::uint64_t first, auto own) { return all_->read(first, own); }, row, records);
}

}  // namespace pointsweep
