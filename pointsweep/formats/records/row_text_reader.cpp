// SPDX-License-Identifier: MIT
#include "pointsweep/formats/records/row_text_reader.h"

#include <algorithm>

namespace pointsweep {

class RowTextReader::Decoder final : public RowDecoder {
 public:
  explicit Decoder(const RowTextReader& reader) : reader_(reader), lines_(*reader.rows_), parser_(reader.parser()) {}

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const std::size_t rows = reader_.rows_for(row, records), stride = reader_.info().schema.stride;
    for (std::size_t i = 0; i < rows; ++i) {
      const std::string_view line = lines_.at(row + i);
      parser_->parse(line, lines_.line(), records.data() + i * stride);
    }
    return rows;
  }

 private:
  const RowTextReader& reader_;
  RowCursor lines_;
  std::unique_ptr<LineParser> parser_;
};

Chunk RowTextReader::chunk_of(std::uint64_t row) const {
  const std::uint64_t place = row / RowLines::kRowsPerPlace, first = place * RowLines::kRowsPerPlace;
  return {first, std::min(RowLines::kRowsPerPlace, info_.count - first), rows_->begin_of(place), rows_->end_of(place),
          std::nullopt};
}

std::unique_ptr<RowDecoder> RowTextReader::decoder(const WantedFields&) const {
  return std::make_unique<Decoder>(*this);
}

}  // namespace pointsweep
