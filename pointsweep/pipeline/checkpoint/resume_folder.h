// SPDX-License-Identifier: MIT
/// The folder in which a run stores its progress, so that another process can continue it (docs/adr/0008), and the list
/// of complete tiles in this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <future>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "pointsweep/storage/local/folder_storage.h"
#include "pointsweep/storage/local/spill_file.h"

namespace pointsweep {

/// A folder with a file `checkpoint`, which is always replaced as a whole, the files of spilled data to which the
/// checkpoint refers, and a list `tiles` of complete tiles. The folder is locked while a process works in it. remove()
/// deletes the folder, and so does the destructor if nothing was ever saved in it.
class ResumeFolder {
 public:
  /// Makes the folder if it is missing. Throws Error if it contains other files, another process uses it, or saved data
  /// are damaged.
  explicit ResumeFolder(const std::filesystem::path& path);
  ~ResumeFolder();
  ResumeFolder(const ResumeFolder&) = delete;
  ResumeFolder& operator=(const ResumeFolder&) = delete;

  /// Name of the file that lists the complete tiles (FinishedTiles). The file is useful only with a checkpoint.
  static constexpr const char* kTiles = "tiles";

  const std::filesystem::path& path() const { return folder_.path(); }
  /// Returns the bytes that earlier processes saved last, as the constructor has read them; empty if none were saved.
  const std::vector<std::byte>& saved() const { return saved_; }
  /// Returns the place of a file for spilled data. `name` begins with "stream-", "results-", "rows-", "mask-" or
  /// "decoded-".
  SpillPlace place(const std::string& name) const { return SpillPlace::kept(path() / name); }
  /// Begins to save `bytes`, which describe the present data of the files `names`. Another thread then flushes both to
  /// the disk: first the data, then the bytes as the file `checkpoint`, so that even after a power failure the
  /// description never exists without its data. Then other data files are removed. Throws the error of the previous
  /// call, if it failed.
  void save(std::vector<std::byte> bytes, const std::set<std::string>& names);
  bool is_saving() const;
  /// Removes all files of spilled data except `names`.
  void keep_only(const std::set<std::string>& names);
  void remove();

 private:
  void load();
  void forget();
  std::vector<std::string> others_than(const std::set<std::string>& names) const;

  LocalFolder folder_;
  bool holds_work_ = false;
  std::mutex removal_;     ///< held while a checkpoint is sealed, and while remove() deletes the checkpoint
  bool removing_ = false;  ///< true once remove() has begun; no checkpoint is sealed after that
  std::vector<std::byte> saved_;
  std::future<void> saving_;
};

/// The list of complete tiles, a file in the folder of checkpoints. A tile is listed twice: by the inode of its
/// unfinished file just before the file is renamed, and by inode, size and time of modification afterwards. So a
/// resumed run recognises each complete tile, even if the earlier process ended during the rename, and does not mistake
/// another file of the same name for it. An object in the network is listed once, by its ETag, size and time of
/// modification.
class FinishedTiles {
 public:
  /// Reads the list of earlier processes. With an empty `resume_folder`, the list stays empty.
  explicit FinishedTiles(const std::filesystem::path& resume_folder);

  /// Returns whether the list has the tile and the file at `output` is the listed file.
  bool has(std::size_t tile, const std::filesystem::path& output) const;
  /// Must be called when the unfinished file of `output` is complete, before it is renamed. Throws Error if the list
  /// cannot be written, like end().
  void begin(std::size_t tile, const std::filesystem::path& output);
  /// Must be called after the rename to `output`.
  void end(std::size_t tile, const std::filesystem::path& output);

 private:
  struct File {
    std::uint64_t device = 0, inode = 0;
    std::uint64_t bytes = 0;
    std::int64_t changed = 0;  ///< time of modification, in ns for files, in s for objects; 0 in entries of begin()
  };
  static bool find(const std::filesystem::path& path, File& file);
  void add(std::size_t tile, const File& file);

  std::filesystem::path list_;
  std::map<std::size_t, File> files_;
};

}  // namespace pointsweep
