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

/// A file or object for reading. Every failure is an Error that names the file and the remedy. Opening a file reads
/// nothing, and no content is kept in memory; for a URL see RemoteObject. Any number of InputFiles may exist. If 256
/// files, or a quarter of the system's limit if that is less, are open, opening another file closes the least recently
/// read files, which are reopened when they are read.
class InputFile final : public Source {
 public:
  /// Throws if the file is missing, is not a regular file, or may not be read.
  explicit InputFile(const std::filesystem::path& path);
  ~InputFile() override;
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  std::filesystem::path path() const { return path_; }
  std::string name() const override { return path_; }
  std::uint64_t size() const override { return size_; }  ///< returns the size that the file had when it was opened

  /// Fills `bytes` from `offset` on. Thread-safe. Throws if the file has become shorter.
  void read_at(std::uint64_t offset, std::span<std::byte> bytes) const override;
  /// Reads up to bytes.size() bytes, fewer at the end of the file, and returns their number.
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// Announces that [begin, end) will be read in sequence, so that few requests to a server bring these bytes
  /// (RemoteObject::will_read()). Has no effect on a file of this machine.
  void will_read(std::uint64_t begin, std::uint64_t end) const;

 private:
  class Lease;
  using OpenFiles = std::list<const InputFile*>;
  void reopen() const;
  void keep_open(FileDescriptor file) const;
  static void close_idle_files();

  std::string path_;  ///< path as a string, which takes a fourth of the memory of a std::filesystem::path
  std::uint64_t size_ = 0;
  std::uint64_t device_ = 0, inode_ = 0;
  std::shared_ptr<RemoteObject> object_;  ///< null for a file of this machine
  // The lock of all open files guards the members below.
  mutable FileDescriptor file_;        ///< holds no file while close_idle_files() has closed it
  mutable unsigned leases_ = 0;        ///< number of running reads, during which the file stays open
  mutable OpenFiles::iterator place_;  ///< place of this file in the list of open files, while the file is open
};

}  // namespace pointsweep
