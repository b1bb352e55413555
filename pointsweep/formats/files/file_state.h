// SPDX-License-Identifier: MIT
/// Whether a file was written to since it was opened.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace pointsweep {

/// What writing to a file changes. Another file that has taken its name meanwhile is no change: a process that had
/// opened the old one still reads that.
class FileState {
 public:
  /// Of what is no file (an array in memory, standard input), nothing is known and nothing ever changes.
  explicit FileState(const std::filesystem::path& path);
  /// As the clock of the file system tells: writes within its tick (some milliseconds) of the first look may be missed.
  bool has_changed() const;
  bool is_known() const { return known_; }
  /// "2400312 bytes, written at 1763705104.123456789"
  std::string text() const;

 private:
  std::filesystem::path path_;
  bool known_ = false;
  std::uint64_t device_ = 0, inode_ = 0, size_ = 0;
  std::int64_t seconds_ = 0, nanoseconds_ = 0;  ///< of the last change of its content
};

}  // namespace pointsweep
