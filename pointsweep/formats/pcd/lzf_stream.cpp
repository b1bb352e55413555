// SPDX-License-Identifier: MIT
#include "pointsweep/formats/pcd/lzf_stream.h"

#include <algorithm>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

constexpr std::size_t kBufferBytes = 64 << 10;

}  // namespace

void LzfStream::go_to(const State& state) { state_ = state; }

void LzfStream::fail_damaged() const {
  fail("{}: its compressed data are damaged or end too early; get the file again.", file_->path().string());
}

std::uint8_t LzfStream::next() {
  if (state_.in >= bytes_) fail_damaged();
  if (state_.in < buffer_begin_ || state_.in >= buffer_begin_ + buffer_.size()) {
    buffer_begin_ = state_.in;
    buffer_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kBufferBytes, bytes_ - state_.in)));
    file_->read_at(offset_ + buffer_begin_, buffer_);
  }
  return static_cast<std::uint8_t>(buffer_[static_cast<std::size_t>(state_.in++ - buffer_begin_)]);
}

/// Begins a run of literals or a match. A control byte below 32 is the number of literals minus 1. Otherwise its upper
/// three bits plus 2 are the length of a match (7: the next byte is added), and its lower five bits with the next byte
/// are the distance minus 1.
void LzfStream::begin_run() {
  const std::uint32_t control = next();
  if (control < 32) {
    state_.literals_left = control + 1;
    return;
  }
  std::uint32_t length = control >> 5;
  if (length == 7) length += next();
  state_.match_left = length + 2;
  state_.match_distance = ((control & 31) << 8 | next()) + 1;
  if (state_.match_distance > state_.out) fail_damaged();
}

void LzfStream::read(std::span<std::byte> out) {
  constexpr std::size_t kMask = std::tuple_size_v<decltype(State::history)> - 1;
  for (std::byte& byte : out) {
    if (state_.literals_left == 0 && state_.match_left == 0) begin_run();
    if (state_.literals_left > 0) {
      byte = std::byte{next()};
      --state_.literals_left;
    } else {
      byte = state_.history[(state_.out - state_.match_distance) & kMask];
      --state_.match_left;
    }
    state_.history[state_.out++ & kMask] = byte;
  }
}

void LzfStream::skip(std::uint64_t bytes) {
  std::array<std::byte, 4096> ignored;
  for (; bytes > 0; bytes -= std::min<std::uint64_t>(bytes, ignored.size()))
    read(std::span(ignored).first(static_cast<std::size_t>(std::min<std::uint64_t>(bytes, ignored.size()))));
}

}  // namespace pointsweep
