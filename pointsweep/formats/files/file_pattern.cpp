// SPDX-License-Identifier: MIT
#include "pointsweep/formats/files/file_pattern.h"

#include <fnmatch.h>

#include <set>
#include <span>
#include <string>
#include <system_error>

#include "pointsweep/formats/files/folders.h"
#include "pointsweep/storage/remote/remote_service.h"
#include "pointsweep/storage/remote/url.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWildcards = "*?[";

bool has_wildcard(const std::string& name) { return name.find_first_of(kWildcards) != name.npos; }

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

std::vector<std::string> names_of(const std::string& key) {
  std::vector<std::string> names(1);
  for (const char c : key) c == '/' ? void(names.emplace_back()) : names.back().push_back(c);
  return names;
}

bool matches(std::span<const std::string> pattern, std::span<const std::string> names) {
  if (pattern.empty()) return names.empty();
  if (pattern[0] == "**") {
    if (matches(pattern.subspan(1), names)) return true;
    if (names.empty() || names[0].starts_with('.')) return false;
    return matches(pattern, names.subspan(1)) || (pattern.size() == 1 && names.size() == 1);
  }
  return !names.empty() && ::fnmatch(pattern[0].c_str(), names[0].c_str(), FNM_PERIOD) == 0 &&
         matches(pattern.subspan(1), names.subspan(1));
}

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

bool is_remote_pattern(const fs::path& url) {
  if (is_bucket(url.native())) return has_wildcard(url.native());
  return url.native().find('*') != std::string::npos;
}

fs::path fixed_remote_part(const fs::path& pattern) {
  const std::string& url = pattern.native();
  return url.substr(0, url.rfind('/', url.find_first_of(kWildcards)) + 1);
}

std::vector<fs::path> remote_matches_of(const fs::path& pattern) {
  const std::string folder = fixed_remote_part(pattern).string();
  const std::vector<std::string> wanted = names_of(pattern.string().substr(folder.size()));
  const bool is_flat = wanted.size() == 1 && wanted[0] != "**";
  std::vector<fs::path> found;
  for (const RemoteEntry& entry : list_remote(folder, !is_flat))
    if (matches(wanted, names_of(entry.url.substr(folder.size())))) found.emplace_back(entry.url);
  return found;
}

}  // namespace pointsweep
