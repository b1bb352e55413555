// SPDX-License-Identifier: MIT
#include "pointsweep/formats/files/file_pattern.h"

#include <fnmatch.h>

#include <set>
#include <string>
#include <system_error>

#include "pointsweep/fail.h"
#include "pointsweep/formats/files/folder_entries.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

bool has_wildcard(const std::string& name) { return name.find_first_of("*?[") != name.npos; }

/// Returns whether the last name of the path has a wildcard and no file or folder has exactly this name.
bool ends_with_pattern(const fs::path& path) {
  std::error_code error;
  return has_wildcard(path.filename().string()) && !fs::exists(fs::symlink_status(path, error));
}

/// Follows the names of a pattern from folder to folder. A name that exists literally matches only itself.
class Matcher {
 public:
  explicit Matcher(const fs::path& pattern) : names_(pattern.begin(), pattern.end()) {}

  std::vector<fs::path> run() {
    follow({}, 0);
    return {found_.begin(), found_.end()};
  }

 private:
  bool is_last(std::size_t n) const { return n + 1 == names_.size(); }

  /// Adds the paths in `folder` that match the names from `n` on. A pattern that ends in '/' has an empty last name.
  void follow(const fs::path& folder, std::size_t n) {
    const std::string name = names_[n].string();
    if (name.empty()) return void(found_.insert(folder));
    if (name == "**") return follow_any_depth(folder, n);
    if (!ends_with_pattern(folder / name)) return go_on(folder / name, n);
    for (const fs::directory_entry& entry : entries_of(folder))
      if (::fnmatch(name.c_str(), entry.path().filename().c_str(), FNM_PERIOD) == 0) go_on(entry.path(), n);
  }

  void go_on(const fs::path& path, std::size_t n) {
    std::error_code error;
    if (!is_last(n)) {
      if (fs::is_directory(path, error)) follow(path, n + 1);
    } else if (fs::exists(path, error) && !fs::is_directory(path, error)) {
      found_.insert(path);
    }
  }

  void follow_any_depth(const fs::path& folder, std::size_t n) {
    if (!is_last(n)) follow(folder, n + 1);
    for (const fs::directory_entry& entry : entries_of(folder)) {
      if (is_hidden(entry.path())) continue;
      if (is_own_folder(entry))
        follow_any_depth(entry.path(), n);
      else if (is_last(n))
        go_on(entry.path(), n);
    }
  }

  std::vector<fs::path> names_;
  std::set<fs::path> found_;
};

}  // namespace

bool is_file_pattern(const fs::path& path) {
  std::error_code error;
  return has_wildcard(path.string()) && !fs::exists(fs::symlink_status(path, error));
}

std::vector<fs::path> matches_of(const fs::path& pattern) { return Matcher(pattern).run(); }

fs::path fixed_part(const fs::path& pattern) {
  fs::path fixed;
  for (auto name = pattern.begin(); std::next(name) != pattern.end() && !ends_with_pattern(fixed / *name); ++name)
    fixed /= *name;
  return fixed;
}

}  // namespace pointsweep
