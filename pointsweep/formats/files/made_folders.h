// SPDX-License-Identifier: MIT
/// Folders that a run makes for its outputs.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "pointsweep/leftovers.h"

namespace pointsweep {

/// Removes the folders that it has made and that are empty when it is destroyed.
class MadeFolders {
 public:
  MadeFolders() = default;
  ~MadeFolders();
  MadeFolders(const MadeFolders&) = delete;
  MadeFolders& operator=(const MadeFolders&) = delete;

  /// Makes the folder of `file`, and the folders that it is in, where they are missing. Throws Error if it cannot.
  void make_for(const std::filesystem::path& file);

 private:
  void make(const std::filesystem::path& folder);

  std::vector<std::filesystem::path> made_;  ///< each after its parent folder
  std::optional<Leftover> first_;
};

}  // namespace pointsweep
