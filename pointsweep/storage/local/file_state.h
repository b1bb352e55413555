// SPDX-License-Identifier: MIT
/// Detects writes to a file since it was opened.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "pointsweep/storage/remote/remote_object.h"

namespace pointsweep {

/// The properties of a file that change with a write. Replacing the file by another one of its name is no change: a
/// process that has opened the old file still reads the old file. For a URL: its size and its ETag, or its time.
class FileState {
 public:
  /// Reads the state of the file. Input that is no file (an array, standard input) has no known state and never
  /// changes. Throws Error for a URL that cannot be opened.
  explicit FileState(const std::filesystem::path& path);
  /// Returns whether the file has changed, by the clock of the file system. Writes within its tick (some milliseconds)
  /// of the first look may be missed.
  bool has_changed() const;
  bool is_known() const { return known_; }
  /// "2400312 bytes, written at 1763705104.123456789", or "2400312 bytes, ETag "5d41402a"" of a URL.
  std::string text() const;

 private:
  std::string path_;  ///< a fourth of the memory of a path
  bool known_ = false;
  std::uint64_t device_ = 0, inode_ = 0, size_ = 0;
  std::int64_t seconds_ = 0, nanoseconds_ = 0;  ///< time of the last change of its content
  std::shared_ptr<const RemoteObject> object_;  ///< open, so that readers find it open; null for a file
};

}  // namespace pointsweep
