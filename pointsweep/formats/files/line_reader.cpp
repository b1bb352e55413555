// SPDX-License-Identifier: MIT
#include "pointsweep/formats/files/line_reader.h"

#include <algorithm>
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

}  // namespace pointsweep
