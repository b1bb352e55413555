// SPDX-License-Identifier: MIT
#include "pointsweep/formats/files/remote_pattern.h"

#include <fnmatch.h>

#include <algorithm>
#include <span>
#include <string>

#include "pointsweep/storage/remote/remote_service.h"
#include "pointsweep/storage/remote/url.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWildcards = "*?[";

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

bool is_remote_pattern(const fs::path& url) {
  if (is_bucket(url.native())) return url.native().find_first_of(kWildcards) != std::string::npos;
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
