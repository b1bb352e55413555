// SPDX-License-Identifier: MIT
/// A temporary folder that only one run uses, its parent folder, and its random name.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "pointsweep/storage/local/descriptor.h"
#include "pointsweep/storage/local/unfinished_output.h"

namespace pointsweep {

/// Throws Error unless `parent` is an existing folder in which this process may create files.
void require_temp_parent(const std::filesystem::path& parent);

/// Returns the folder `asked`, or the system's folder for temporary files if `asked` is empty.
std::filesystem::path temp_parent(const std::filesystem::path& asked);

/// Returns `begin` and six lower-case letters or digits. Names almost certainly differ from call to call and from
/// process to process.
std::string random_name(const std::string& begin);

/// A folder `<parent>/pointsweep-<pid>-<random>`, mode 0700, which the destructor removes with all its files. The
/// constructor first removes temporary folders of this user in `parent` whose process has ended, for example by kill
/// -9.
class TempFolder {
 public:
  explicit TempFolder(const std::filesystem::path& parent);
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::optional<Leftover> leftover_;  ///< entry for `path_`, the folder to remove if the process is stopped
  FileDescriptor lock_;               ///< the open folder, locked while this process uses it
};

}  // namespace pointsweep
