// SPDX-License-Identifier: MIT
/// Spilled data: one temporary file in which many threads write and read at reserved places.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "pointsweep/storage/local/descriptor.h"

namespace pointsweep {

class TempFolder;

/// The place of spilled data: memory; a file that is unlinked right after opening, so that it vanishes even if the
/// process is killed; or a file that is kept so that the run can be resumed.
class SpillPlace {
 public:
  /// The place is memory if `folder` is null.
  SpillPlace(const TempFolder* folder);  // NOLINT: implicit, since a folder is a place
  static SpillPlace kept(const std::filesystem::path& file);

  /// Returns whether the place is a file, not memory.
  explicit operator bool() const { return !folder_.empty(); }
  bool is_kept() const { return !name_.empty(); }
  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path file() const { return folder_ / name_; }

 private:
  std::filesystem::path folder_;
  std::string name_;
};

/// A file for spilled data, or a kept file that a resumed run opens again. Threads reserve ranges of the file, then
/// write and read them. Thread-safe for ranges that do not overlap.
class SpillFile {
 public:
  /// Creates a new file; replaces a kept file of the same name.
  explicit SpillFile(const SpillPlace& place);
  /// Opens a kept file whose first `bytes` bytes are in use, and cuts off all other bytes. Throws Error if the file is
  /// shorter.
  SpillFile(const SpillPlace& place, std::uint64_t bytes);

  /// Reserves `bytes` bytes of the file for the caller and returns their offset. Thread-safe.
  std::uint64_t reserve(std::uint64_t bytes) { return reserved_.fetch_add(bytes, std::memory_order_relaxed); }
  /// Throws Error, with the remedy if no space is left.
  void write(std::uint64_t offset, std::span<const std::byte> bytes);
  void read(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// Turns the read-ahead of the system off, for files that are read in scattered pieces.
  void expect_scattered_reads() const;
  /// Lets the system begin to read bytes that read() will soon request.
  void will_read(std::uint64_t offset, std::uint64_t bytes) const;

  /// Returns the bytes reserved so far, which are the part of the file in use.
  std::uint64_t end() const { return reserved_.load(std::memory_order_relaxed); }
  /// Returns the bytes written by this process.
  std::uint64_t written_bytes() const { return written_.load(std::memory_order_relaxed); }

 private:
  std::string parent_;  ///< folder that the user has chosen, for messages
  std::string option_;  ///< option by which the user has chosen the folder, for messages
  FileDescriptor file_;
  std::atomic<std::uint64_t> reserved_{0}, written_{0};
};

}  // namespace pointsweep
