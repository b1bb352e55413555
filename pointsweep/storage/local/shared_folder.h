// SPDX-License-Identifier: MIT
/// A folder that several processes, on several machines, use as one storage.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
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

}  // namespace pointsweep
