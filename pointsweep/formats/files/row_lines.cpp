// SPDX-License-Identifier: MIT
#include "pointsweep/formats/files/row_lines.h"

#include <cassert>

#include "pointsweep/fail.h"

namespace pointsweep {

RowLines::RowLines(LineReader lines, IsRow is_a_row, std::uint64_t most, const UseOther& use_other)
    : file_(&lines.file()), is_row_(is_a_row) {
  while (count_ < most) {
    const Place place{lines.offset(), lines.next_line()};
    const auto line = lines.next();
    if (!line) break;
    if (!is_row_(*line)) {
      if (use_other) use_other(*line, place.line, count_);
      continue;
    }
    if (count_ % kRowsPerPlace == 0) places_.push_back(place);
    ++count_;
  }
  end_ = lines.offset();
}

std::string_view RowCursor::at(std::uint64_t row) {
  assert(row < rows_->count());
  const std::uint64_t place = row / RowLines::kRowsPerPlace;
  if (row < next_row_ || place > next_row_ / RowLines::kRowsPerPlace) {
    lines_.jump(rows_->place(place).offset, rows_->place(place).line);
    next_row_ = place * RowLines::kRowsPerPlace;
  }
  for (; next_row_ < row; ++next_row_) advance();
  ++next_row_;
  return advance();
}

std::string_view RowCursor::advance() {
  while (const auto line = lines_.next()) {
    if (rows_->is_row(*line)) return *line;
  }
  fail("{}: has fewer rows than when it was opened; run again once it is complete.", lines_.file().path().string());
}

}  // namespace pointsweep
