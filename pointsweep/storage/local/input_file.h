// SPDX-License-Identifier: MIT
/// A regular file, or an object in the network, opened for reading at any place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <span>
#include <string>

#include "pointsweep/storage/local/descriptor.h"
#include "pointsweep/storage/remote/remote_object.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// Every failure is an Error that names the file and says what to do. Of a file, opening reads nothing, and nothing is
/// kept in memory; of a URL see RemoteObject. There may be any number of them: those that were not read for the longest
/// time are closed where more than 256, or a quarter of what the system allows, would be open, and opened again when
/// they are read.
class InputFile final : public Source {
 public:
  /// Throws when the file is missing, a folder, no regular file, or may not be read.
  explicit InputFile(const std::filesystem::path& path);
  ~InputFile() override;
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  std::filesystem::path path() const { return path_; }
  std::string name() const override { return path_; }
  std::uint64_t size() const override { return size_; }  ///< when it was opened

  /// Fills `bytes` from `offset` on. Thread-safe. Throws when the file has become shorter.
  void read_at(std::uint64_t offset, std::span<std::byte> bytes) const override;
  /// Reads as many bytes as there are up to the end of the file, at most bytes.size(), and returns how many.
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// Says that [begin, end) will be read in sequence, so that a server is asked for these bytes at once.
  void will_read(std::uint64_t begin, std::uint64_t end) const;

 private:
  class Lease;
  using OpenFiles = std::list<const InputFile*>;
  void reopen() const;
  static void close_idle_files();

  std::string path_;  ///< a fourth of the memory of a path
  std::uint64_t size_ = 0;
  std::uint64_t device_ = 0, inode_ = 0;
  std::shared_ptr<RemoteObject> object_;  ///< null for a file of this machine
  // Under the lock of all open files.
  mutable FileDescriptor file_;        ///< nothing is open: closed for now
  mutable unsigned leases_ = 0;        ///< reads under way
  mutable OpenFiles::iterator place_;  ///< among the open files, while it is open
};

}  // namespace pointsweep
