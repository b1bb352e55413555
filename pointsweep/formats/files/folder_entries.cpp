// SPDX-License-Identifier: MIT
#include "pointsweep/formats/files/folder_entries.h"

#include <system_error>

#include "pointsweep/fail.h"

namespace pointsweep {

namespace fs = std::filesystem;

std::vector<fs::directory_entry> entries_of(const fs::path& folder) {
  std::vector<fs::directory_entry> entries;
  std::error_code error;
  fs::directory_iterator entry(folder.empty() ? fs::path(".") : folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error))
    entries.emplace_back(folder.empty() ? entry->path().filename() : entry->path());
  if (error)
    fail("{}: the folder cannot be read: {}; check its permissions.", folder.empty() ? "." : folder.string(),
         error.message());
  return entries;
}

bool is_hidden(const fs::path& path) { return path.filename().string().starts_with('.'); }

bool is_own_folder(const fs::directory_entry& entry) {
  std::error_code error;
  return fs::is_directory(entry.symlink_status(error));
}

}  // namespace pointsweep
