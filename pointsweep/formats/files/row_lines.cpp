// SPDX-License-Identifier: MIT
#include "pointsweep/formats/files/row_lines.h"

#include <cassert>

#include "pointsweep/error.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kRowsPerPlace = 65536;

}  // namespace

RowLines::RowLines(const LineReader& lines, IsRow is_row, std::uint64_t most) : lines_(lines), is_row_(is_row) {
  while (count_ < most) {
    const Place place{lines_.offset(), lines_.next_line()};
    const auto line = lines_.next();
    if (!line) break;
    if (!is_row(*line)) continue;
    if (count_ % kRowsPerPlace == 0) places_.push_back(place);
    ++count_;
  }
  rest();
}

void RowLines::rest() {
  lines_ = LineReader(lines_.file());
  next_row_ = count_;  // so that the next row asked for is found from its place
}

std::string_view RowLines::at(std::uint64_t row) {
  assert(row < count_);
  const std::uint64_t place = row / kRowsPerPlace;
  if (row < next_row_ || place > next_row_ / kRowsPerPlace) {
    lines_.jump(places_[place].offset, places_[place].line);
    next_row_ = place * kRowsPerPlace;
  }
  for (; next_row_ < row; ++next_row_) advance();
  ++next_row_;
  return advance();
}

std::string_view RowLines::advance() {
  while (const auto line = lines_.next()) {
    if (is_row_(*line)) return *line;
  }
  fail("{}: has fewer rows than when it was opened; run again when nobody writes to it.",
       lines_.file().path().string());
}

}  // namespace pointsweep
