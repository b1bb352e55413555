// SPDX-License-Identifier: MIT
/// A regular file opened for reading at any place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace pointsweep {

/// Every failure is an Error that names the file and says what to do. Reads nothing on opening, keeps nothing in
/// memory.
class InputFile {
 public:
  /// Throws when the file is missing, a folder, no regular file, or may not be read.
  explicit InputFile(const std::filesystem::path& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }  ///< when it was opened

  /// Fills `bytes` from `offset` on. Thread-safe. Throws when the file has become shorter.
  void read_at(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// Reads as many bytes as there are up to the end of the file, at most bytes.size(), and returns how many.
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace pointsweep
