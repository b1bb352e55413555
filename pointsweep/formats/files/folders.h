// SPDX-License-Identifier: MIT
/// Folders of this machine: the entries of a folder, and the folders that a run makes for its outputs.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "pointsweep/storage/local/unfinished_output.h"

namespace pointsweep {

/// Returns the files and folders in `folder`, in no particular order. "" is the current folder; the paths of its
/// entries are file names without a folder. Throws Error if the folder cannot be read.
std::vector<std::filesystem::directory_entry> entries_of(const std::filesystem::path& folder);

/// Returns whether the name of the file begins with a dot.
bool is_hidden(const std::filesystem::path& path);

/// Returns whether the entry is a folder and no symbolic link. Links may lead in circles.
bool is_own_folder(const std::filesystem::directory_entry& entry);

/// Makes folders, and its destructor removes the made folders that are empty.
class MadeFolders {
 public:
  MadeFolders() = default;
  ~MadeFolders();
  MadeFolders(const MadeFolders&) = delete;
  MadeFolders& operator=(const MadeFolders&) = delete;

  /// Makes the missing folders on the path of `file`; none for a URL. Throws Error if a folder cannot be made.
  void make_for(const std::filesystem::path& file);

 private:
  void make(const std::filesystem::path& folder);

  std::vector<std::filesystem::path> made_;  ///< folders, outer before inner
  std::optional<Leftover> first_;
};

}  // namespace pointsweep
