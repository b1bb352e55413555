// SPDX-License-Identifier: MIT
/// A decompressor of LZF (Marc Lehmann's format) that works in pieces and can resume at saved states.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {

/// Decompresses a block of a file from begin to end in little memory, for any length of the block. liblzf needs all
/// input and all output in memory at once.
class LzfStream {
 public:
  /// The state of a stream between two reads; 8 KB.
  struct State {
    std::uint64_t in = 0;                                                 ///< compressed bytes read
    std::uint64_t out = 0;                                                ///< decompressed bytes returned
    std::uint32_t match_distance = 0, match_left = 0, literals_left = 0;  ///< rest of a run of literals or of a match
    std::array<std::byte, 8192> history{};  ///< last bytes returned, each at its place in the block modulo 8192
  };

  /// Decompresses the block of `bytes` compressed bytes from `offset` on. `file` must outlive the stream.
  LzfStream(const InputFile& file, std::uint64_t offset, std::uint64_t bytes)
      : file_(&file), offset_(offset), bytes_(bytes) {}

  const State& state() const { return state_; }
  void go_to(const State& state);
  /// Reads the next bytes. Throws Error if the block ends too early, or refers to bytes before its beginning.
  void read(std::span<std::byte> out);
  void skip(std::uint64_t bytes);

 private:
  void begin_run();
  std::uint8_t next();
  [[noreturn]] void fail_damaged() const;

  const InputFile* file_;
  std::uint64_t offset_, bytes_;
  State state_;
  std::vector<std::byte> buffer_;  ///< compressed bytes from buffer_begin_ on
  std::uint64_t buffer_begin_ = 0;
};

}  // namespace pointsweep
