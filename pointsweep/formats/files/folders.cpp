// SPDX-License-Identifier: MIT
#include "pointsweep/formats/files/folders.h"

#include <unistd.h>

#include <system_error>

#include "pointsweep/fail.h"
#include "pointsweep/storage/remote/url.h"

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

MadeFolders::~MadeFolders() {
  for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) ::rmdir(folder->c_str());
}

void MadeFolders::make_for(const fs::path& file) {
  const fs::path folder = file.parent_path();
  if (!folder.empty() && !is_url(folder)) make(folder);
}

void MadeFolders::make(const fs::path& folder) {
  std::error_code error;
  if (fs::is_directory(folder, error)) return;
  if (folder.has_parent_path() && folder.parent_path() != folder) make(folder.parent_path());
  if (!first_) first_.emplace(folder);
  if (fs::create_directory(folder, error)) made_.push_back(folder);
  if (error) fail("{}: the folder cannot be made: {}; name another one.", folder.string(), error.message());
}

}  // namespace pointsweep
