// SPDX-License-Identifier: MIT
/// Storages whose objects are files: of a folder of one run on this machine, and of a folder that several processes on
/// several machines share; and a storage whose objects are those of a bucket below a prefix.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/storage/local/descriptor.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// A folder whose sealed objects are safely on the disk: each object is complete even after a power failure. No other
/// LocalFolder can be made for the folder during the lifetime of this object, if the file system has locks.
class LocalFolder final : public Storage {
 public:
  /// Makes the folder if it is missing. Throws Error if the folder cannot be made, or if another process uses it. Error
  /// messages call an object `object` ("a checkpoint") and name the `option` that chose the folder.
  LocalFolder(const std::filesystem::path& path, const std::string& object, const std::string& option);

  const std::filesystem::path& path() const { return path_; }
  std::unique_ptr<Source> open(const std::string& key) const override;
  std::unique_ptr<Unsealed> create(const std::string& key) override;
  /// Returns the names of all files except files of unsealed objects; empty if the folder does not exist.
  std::vector<std::string> list() const override;
  /// Removes the file of the object, and the file that a killed process may have left of an unsealed object with this
  /// key.
  void remove(const std::string& key) override;
  /// Flushes the content of a file that was changed in place to the disk.
  void flush(const std::string& key) const;
  /// Flushes the names of the files to the disk. Has no effect on file systems that cannot flush a folder.
  void flush() const;
  /// Throws the Error for a write that failed with the errno `error`.
  [[noreturn]] void fail_to_write(int error) const;
  /// Removes the folder if it is empty.
  void remove_folder();

 private:
  std::filesystem::path path_;
  std::string object_, option_;
  FileDescriptor folder_;  ///< the open folder, which this process has locked
};

/// Returns the storage that several processes share in a folder, or in a folder of a bucket if `place` is a URL.
/// Several processes may create objects with the same key, since objects appear complete. Until an object of a bucket
/// is sealed, its bytes are in the system's folder for temporary files.
std::unique_ptr<Storage> shared_storage(const std::filesystem::path& place);

}  // namespace pointsweep
