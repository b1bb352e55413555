// SPDX-License-Identifier: MIT
/// The list of complete tiles of a resumable run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>

namespace pointsweep {

/// A list in the folder of checkpoints. A tile is listed by the inode of its unfinished file just before that gets its
/// name, and by inode, size and time of change once it has the name. So a process that is resumed knows each tile that
/// is complete, whenever the process before it ended, and takes no other file of that name for one.
class FinishedTiles {
 public:
  /// Reads the list that earlier processes have left. With an empty `resume_folder`, nothing is listed.
  explicit FinishedTiles(const std::filesystem::path& resume_folder);

  bool has(std::size_t tile, const std::filesystem::path& output) const;
  /// To be called when everything is written to the unfinished file of `output`, before it gets its name. Throws Error
  /// if the list cannot be written, as end() does.
  void begin(std::size_t tile, const std::filesystem::path& output);
  /// To be called when `output` has its name.
  void end(std::size_t tile, const std::filesystem::path& output);

 private:
  struct File {
    std::uint64_t device = 0, inode = 0;
    std::uint64_t bytes = 0;
    std::int64_t changed = 0;  ///< ns; 0: it had no name yet when it was listed
  };
  static bool find(const std::filesystem::path& path, File& file);
  void add(std::size_t tile, const File& file);

  std::filesystem::path list_;
  std::map<std::size_t, File> files_;
};

}  // namespace pointsweep
