// SPDX-License-Identifier: MIT
#include "pointsweep/formats/files/line_reader.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

constexpr std::size_t kReadBytes = 64 << 10;  // bytes of a read; each reading thread has a buffer of this size
constexpr std::size_t kLongestLine = 1 << 20;

std::string_view without_carriage_return(const std::byte* text, std::size_t size) {
  const std::string_view line(reinterpret_cast<const char*>(text), size);
  return line.ends_with('\r') ? line.substr(0, size - 1) : line;
}

}  // namespace

std::optional<std::string_view> LineReader::next() {
  std::size_t searched = 0;
  for (;;) {
    const std::byte* start = block_.data() + at_;
    const std::size_t size = end_ - at_;
    const void* found = size == searched ? nullptr : std::memchr(start + searched, '\n', size - searched);
    if (found != nullptr) {
      const auto length = static_cast<std::size_t>(static_cast<const std::byte*>(found) - start);
      at_ += length + 1;
      ++next_line_;
      return without_carriage_return(start, length);
    }
    searched = size;
    if (read_more()) continue;
    if (size == 0) return std::nullopt;
    at_ = end_;
    ++next_line_;
    return without_carriage_return(block_.data() + end_ - size, size);
  }
}

void LineReader::jump(std::uint64_t offset, std::uint64_t line) {
  block_offset_ = offset;
  at_ = end_ = 0;
  next_line_ = line;
}

/// Appends a block to the unread bytes. Returns false at the end of the file.
bool LineReader::read_more() {
  const std::size_t unread = end_ - at_;
  if (unread > kLongestLine) {
    fail("{}: line {} is longer than {} bytes; this is no text file of points.", file_->path().string(), next_line_,
         kLongestLine);
  }
  if (unread != 0 && at_ != 0) std::memmove(block_.data(), block_.data() + at_, unread);
  block_offset_ += at_;
  at_ = 0;
  end_ = unread;
  block_.resize(std::max(block_.size(), unread + kReadBytes));
  const std::size_t got = file_->read_some(block_offset_ + unread, std::span(block_).subspan(unread));
  end_ += got;
  return got != 0;
}

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
