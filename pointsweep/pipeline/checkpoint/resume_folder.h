// SPDX-License-Identifier: MIT
/// The folder in which a run keeps what it has done, so that another process can go on with it (docs/adr/0008).
#pragma once

#include <cstddef>
#include <filesystem>
#include <future>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "pointsweep/storage/local/local_folder.h"
#include "pointsweep/storage/local/spill_file.h"

namespace pointsweep {

/// Holds a file `checkpoint`, replaced as a whole, and the spilled data it speaks of. Locked while a process works in
/// it. Removed by remove(), and by the destructor if nothing was ever saved in it.
class ResumeFolder {
 public:
  /// Makes the folder if it is missing. Throws Error if it holds anything else, another process works in it, or what
  /// was saved is damaged.
  explicit ResumeFolder(const std::filesystem::path& path);
  ~ResumeFolder();
  ResumeFolder(const ResumeFolder&) = delete;
  ResumeFolder& operator=(const ResumeFolder&) = delete;

  /// A file of FinishedTiles, which is of use with a checkpoint only.
  static constexpr const char* kTiles = "tiles";

  const std::filesystem::path& path() const { return folder_.path(); }
  /// Returns the bytes that were saved last, by any process; empty if nothing was saved.
  const std::vector<std::byte>& saved() const { return saved_; }
  /// A file for spilled data; `name` begins with "stream-", "results-", "rows-", "mask-" or "decoded-".
  SpillPlace place(const std::string& name) const { return SpillPlace::kept(path() / name); }
  /// Begins to save `bytes`, which describe the present data of the files `names`, and returns while another thread
  /// flushes both to the disk: first the data, then the bytes under their name, so that not even a loss of power
  /// leaves one without the other. Then other data files are removed. Throws what went wrong the last time.
  void save(std::vector<std::byte> bytes, const std::set<std::string>& names);
  bool is_saving() const;
  /// Removes all spilled data but files of these names.
  void keep_only(const std::set<std::string>& names);
  void remove();

 private:
  void load();
  void forget();
  std::vector<std::string> others_than(const std::set<std::string>& names) const;

  LocalFolder folder_;
  bool holds_work_ = false;
  std::mutex removal_;     ///< between a checkpoint that gets its name and remove()
  bool removing_ = false;  ///< no checkpoint gets its name any more
  std::vector<std::byte> saved_;
  std::future<void> saving_;
};

}  // namespace pointsweep
