// SPDX-License-Identifier: MIT
/// Storages that several processes on several machines share: a folder, or a part of a bucket.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// A folder that several processes share, with objects as files. If two processes create objects with the same key, the
/// object sealed last remains. Files are not flushed to the disk: a power failure may damage an object, which a
/// checksum reveals (sealed_bytes()). A killed process may leave the file of an unsealed object.
class SharedFolder final : public Storage {
 public:
  /// Uses the folder `path`, which must exist.
  explicit SharedFolder(std::filesystem::path path) : path_(std::move(path)) {}

  std::unique_ptr<Source> open(const std::string& key) const override;
  std::unique_ptr<Unsealed> create(const std::string& key) override;
  /// Returns the names of all files except files of unsealed objects.
  std::vector<std::string> list() const override;
  void remove(const std::string& key) override;

 private:
  std::filesystem::path path_;
};

/// A folder of a bucket. Since objects only appear complete, several processes may create objects with the same key.
class RemoteFolder final : public Storage {
 public:
  /// Uses the folder `url`, which must end in '/'.
  explicit RemoteFolder(std::string url) : url_(std::move(url)) {}

  std::unique_ptr<Source> open(const std::string& key) const override;
  /// Begins an object, whose bytes are in the system's folder for temporary files until it is sealed.
  std::unique_ptr<Unsealed> create(const std::string& key) override;
  std::vector<std::string> list() const override;
  void remove(const std::string& key) override;

 private:
  std::string url_;
};

/// Returns the storage that a path or a URL names.
std::unique_ptr<Storage> shared_storage(const std::filesystem::path& place);

}  // namespace pointsweep
