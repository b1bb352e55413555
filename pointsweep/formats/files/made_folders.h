// SPDX-License-Identifier: MIT
/// Folders that a run makes for its outputs.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "pointsweep/leftovers.h"

namespace pointsweep {

/// Makes folders, and its destructor removes the made folders that are empty.
class MadeFolders {
 public:
  MadeFolders() = default;
  ~MadeFolders();
  MadeFolders(const MadeFolders&) = delete;
  MadeFolders& operator=(const MadeFolders&) = delete;

  /// Makes the missing folders on the path of `file`. Throws Error if one cannot be made.
  void make_for(const std::filesystem::path& file);

 private:
  void make(const std::filesystem::path& folder);

  std::vector<std::filesystem::path> made_;  ///< each after its parent folder
  std::optional<Leftover> first_;
};

}  // namespace pointsweep
