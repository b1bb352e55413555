// SPDX-License-Identifier: MIT
/// Open files, folders and standard streams of the system (program/standard_streams.h).
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>

namespace pointsweep {

/// A file or folder that the destructor closes.
class FileDescriptor {
 public:
  /// Takes ownership of an open file of the system; -1 for no file.
  explicit FileDescriptor(int number = -1) : number_(number) {}
  ~FileDescriptor() { close(); }
  FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }

  int number() const { return number_; }
  explicit operator bool() const { return number_ >= 0; }
  /// Closes the file. Returns 0 or an errno: network file systems and quotas may report only now that bytes could not
  /// be stored.
  int close();

  /// Writes all bytes from `offset` on. Returns 0, or the errno of the system, ENOSPC if it accepts no more bytes.
  /// Thread-safe.
  int write_at(std::uint64_t offset, std::span<const std::byte> bytes) const;
  struct Got {
    std::size_t bytes;  ///< number of bytes read; fewer than requested at the end of the file or if `error` is set
    int error;          ///< 0, or the errno of a failure
  };
  /// Reads bytes from `offset` on. Thread-safe.
  Got read_at(std::uint64_t offset, std::span<std::byte> bytes) const;

 private:
  int number_;
};

/// Opens a folder, so that it can be locked; fails on a symbolic link unless `follow_link`. After a failure, the
/// descriptor holds no file, and errno has the reason.
FileDescriptor open_folder(const std::filesystem::path& path, bool follow_link);
/// Makes a file without a name in a folder. It vanishes when it is closed, even if the process is killed. After a
/// failure, the descriptor holds no file, and errno has the reason.
FileDescriptor open_nameless(const std::filesystem::path& folder);
/// Locks an open file or folder until it is closed. Returns 0 or an errno; EWOULDBLOCK if another process has the lock.
int lock(const FileDescriptor& descriptor);

/// Returns the descriptor from which standard input is read; -1 until take_standard_input() has been called.
int standard_input_descriptor();
/// Writes like write(2). Streams other than regular files get small pieces, so that a request to stop is noticed while
/// the reader is slow. Throws Cancelled on such a request.
ssize_t write_to_stream(int descriptor, std::span<const std::byte> bytes);

}  // namespace pointsweep
