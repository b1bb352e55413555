// SPDX-License-Identifier: MIT
/// A folder, or a part of a bucket, that several processes, on several machines, use as one storage.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// Objects are files. Two processes may create an object of the same key: the one that is sealed last stays. Nothing is
/// forced to the disk, so after a loss of power an object may be damaged; it has a checksum. A killed process may leave
/// the file of an unsealed object.
class SharedFolder final : public Storage {
 public:
  /// The folder must exist.
  explicit SharedFolder(std::filesystem::path path) : path_(std::move(path)) {}

  std::unique_ptr<Source> open(const std::string& key) const override;
  std::unique_ptr<Unsealed> create(const std::string& key) override;
  /// Returns the names of all files but those of unsealed objects.
  std::vector<std::string> list() const override;
  void remove(const std::string& key) override;

 private:
  std::filesystem::path path_;
};

/// A folder of a bucket. An object that is put is complete, so those of one key may come from several processes here,
/// too.
class RemoteFolder final : public Storage {
 public:
  /// `url` ends in '/'.
  explicit RemoteFolder(std::string url) : url_(std::move(url)) {}

  std::unique_ptr<Source> open(const std::string& key) const override;
  /// The object waits in the system's folder for temporary files until it is sealed.
  std::unique_ptr<Unsealed> create(const std::string& key) override;
  std::vector<std::string> list() const override;
  void remove(const std::string& key) override;

 private:
  std::string url_;
};

/// Returns the storage that a path or a URL names.
std::unique_ptr<Storage> shared_storage(const std::filesystem::path& place);

}  // namespace pointsweep
