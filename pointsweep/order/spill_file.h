// SPDX-License-Identifier: MIT
/// One temporary file that many threads write and read at places they reserve.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace pointsweep {

class TempFolder;

/// The file has no name any more as soon as it is open, so that nothing is left of it however the process ends.
class SpillFile {
 public:
  explicit SpillFile(const TempFolder& folder);
  ~SpillFile();
  SpillFile(const SpillFile&) = delete;
  SpillFile& operator=(const SpillFile&) = delete;

  /// The offset of `bytes` bytes that belong to the caller from now on.
  std::uint64_t reserve(std::uint64_t bytes) { return reserved_.fetch_add(bytes, std::memory_order_relaxed); }
  /// Throws Error that says what to do when no space is left.
  void write(std::uint64_t offset, std::span<const std::byte> bytes);
  void read(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// Gives the space back to the file system where it can do that; the bytes must not be read again.
  void discard(std::uint64_t offset, std::uint64_t bytes);

  std::uint64_t written_bytes() const { return written_.load(std::memory_order_relaxed); }

 private:
  std::string parent_;  ///< for messages: the folder the user chose
  int descriptor_ = -1;
  std::atomic<std::uint64_t> reserved_{0}, written_{0};
};

}  // namespace pointsweep
