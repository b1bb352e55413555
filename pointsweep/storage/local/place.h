// SPDX-License-Identifier: MIT
/// Facts about files and folders that a path or a URL names, and detection of writes to a file since it was opened.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "pointsweep/storage/remote/remote_object.h"

namespace pointsweep {

/// Returns whether the path names an existing folder. A URL names a folder if it ends in '/'; no request is
/// sent.
bool is_folder(const std::filesystem::path& path);
/// Returns whether a file, folder or object of this name exists.
bool exists_at(const std::filesystem::path& path);
/// Returns the size in bytes of a regular file or of an object; nothing if there is no file or object of this name.
std::optional<std::uint64_t> bytes_of_file(const std::filesystem::path& path);
/// Returns the absolute path without `.` and `..`; returns a URL and an empty path unchanged.
std::string whole_name(const std::filesystem::path& path);
/// Returns the name of the file without its folders, and without the query of a URL.
std::filesystem::path file_name(const std::filesystem::path& path);
/// Returns whether both files are in the same folder.
bool share_folder(const std::filesystem::path& a, const std::filesystem::path& b);

/// The properties of a file that change with a write. Replacing the file by another file of this name does not count as
/// a change: a process that has opened the old file still reads the old file. The state of a URL is the size and the
/// ETag of its object, or the size and the time of the last change if the server states no ETag.
class FileState {
 public:
  /// Reads the state of the file. Input that is not a file (an array, standard input) has no known state and counts as
  /// unchanged. Throws Error for a URL that cannot be opened.
  explicit FileState(const std::filesystem::path& path);
  /// Returns whether the file has changed, by the clock of the file system. A write within one tick of that clock (some
  /// milliseconds) after the state was read may be missed.
  bool has_changed() const;
  bool is_known() const { return known_; }
  /// Returns a text like "2400312 bytes, written at 1763705104.123456789"; for a URL like "2400312 bytes, ETag
  /// "5d41402a"".
  std::string text() const;

 private:
  std::string path_;  ///< path as a string, which takes a fourth of the memory of a std::filesystem::path
  bool known_ = false;
  std::uint64_t device_ = 0, inode_ = 0, size_ = 0;
  std::int64_t seconds_ = 0, nanoseconds_ = 0;  ///< time of the last change of the file's content
  /// Object of a URL, kept open so that readers need not open it again; null for a file.
  std::shared_ptr<const RemoteObject> object_;
};

}  // namespace pointsweep
