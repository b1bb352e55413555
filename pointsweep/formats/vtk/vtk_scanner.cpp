// SPDX-License-Identifier: MIT
/// The text of a VTK file, by words and by lines.
#include <cstring>

#include "pointsweep/fail.h"
#include "pointsweep/formats/files/number_text.h"
#include "pointsweep/formats/vtk/vtk_layout.h"

namespace pointsweep {
namespace {

constexpr std::size_t kVtkWindow = 16 << 10;

bool is_blank_byte(std::byte b) { return is_space(static_cast<char>(b)); }

}  // namespace

void VtkScanner::jump(std::uint64_t offset) {
  block_offset_ = offset;
  at_ = end_ = 0;
}

/// Moves the unread bytes to the front of the window and fills the rest; false at the end of the file.
bool VtkScanner::read_more() {
  block_.resize(kVtkWindow);
  const std::size_t unread = end_ - at_;
  if (unread == kVtkWindow)
    fail("{}: byte {}: a word or line is longer than {} bytes; the file is damaged.", file_->path().string(), offset(),
         kVtkWindow);
  std::memmove(block_.data(), block_.data() + at_, unread);
  block_offset_ += at_;
  at_ = 0;
  end_ = unread;
  const std::size_t got = file_->read_some(block_offset_ + unread, std::span(block_).subspan(unread));
  end_ += got;
  return got != 0;
}

bool VtkScanner::skip_blanks() {
  for (;;) {
    while (at_ < end_ && is_blank_byte(block_[at_])) ++at_;
    if (at_ < end_) return true;
    if (!read_more()) return false;
  }
}

std::optional<std::string_view> VtkScanner::word() {
  if (!skip_blanks()) return std::nullopt;
  for (std::size_t length = 1;; ++length) {
    if (at_ + length == end_ && !read_more()) length = end_ - at_;
    if (at_ + length < end_ && !is_blank_byte(block_[at_ + length])) continue;
    const std::string_view word(reinterpret_cast<const char*>(block_.data() + at_), length);
    at_ += length;
    return word;
  }
}

std::optional<std::string_view> VtkScanner::line() {
  for (std::size_t searched = 0;;) {
    const void* found = nullptr;
    if (end_ - at_ > searched) found = std::memchr(block_.data() + at_ + searched, '\n', end_ - at_ - searched);
    searched = end_ - at_;
    if (found == nullptr && read_more()) continue;
    if (found == nullptr && at_ == end_) return std::nullopt;
    const std::byte* const begin = block_.data() + at_;
    const std::size_t length =
        found == nullptr ? end_ - at_ : static_cast<std::size_t>(static_cast<const std::byte*>(found) - begin);
    at_ += length + (found == nullptr ? 0 : 1);
    const std::string_view line(reinterpret_cast<const char*>(begin), length);
    return line.ends_with('\r') ? line.substr(0, length - 1) : line;
  }
}

std::uint64_t VtkScanner::skip_words(std::uint64_t words) {
  std::uint64_t passed = 0;
  while (passed < words && word()) ++passed;
  return passed;
}

}  // namespace pointsweep
