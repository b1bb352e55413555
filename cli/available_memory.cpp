// SPDX-License-Identifier: MIT
#include "cli/available_memory.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <string>

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

/// The number in a file that holds nothing else; none for "max" and for a missing file.
std::optional<std::uint64_t> number_in(const fs::path& file) {
  std::ifstream in(file);
  std::uint64_t value = 0;
  if (in >> value) return value;
  return std::nullopt;
}

/// The number behind a word at the start of a line.
std::optional<std::uint64_t> number_after(const fs::path& file, const std::string& word) {
  std::ifstream in(file);
  for (std::string line, first; std::getline(in, line);) {
    if (line.starts_with(word + " ") || line.starts_with(word + ":")) return std::stoull(line.substr(word.size() + 1));
  }
  return std::nullopt;
}

/// What one control group leaves: its limit, less what is used by more than cached files, which give way.
std::optional<std::uint64_t> left_in_group(const fs::path& group, const char* limit_file, const char* used_file,
                                           const char* cached) {
  const auto limit = number_in(group / limit_file);
  if (!limit) return std::nullopt;
  const std::uint64_t cache = number_after(group / "memory.stat", cached).value_or(0);
  const std::uint64_t used = number_in(group / used_file).value_or(0);
  const std::uint64_t held = used > cache ? used - cache : 0;
  return *limit > held ? *limit - held : 0;
}

/// The group's path as /proc/self/cgroup states it: "0::/path" (version 2) or "5:memory:/path" (version 1).
std::string group_path(const fs::path& root, const std::string& mark) {
  std::ifstream in(root / "proc/self/cgroup");
  for (std::string line; std::getline(in, line);) {
    const auto at = line.find(mark);
    if (at != std::string::npos) return line.substr(at + mark.size());
  }
  return "/";
}

/// The least that the process's own group and the groups around it leave.
std::optional<std::uint64_t> left_in_groups(const fs::path& mount, const fs::path& own, const char* limit_file,
                                            const char* used_file, const char* cached) {
  std::optional<std::uint64_t> least;
  for (fs::path group = own.relative_path();; group = group.parent_path()) {
    const auto left = left_in_group(mount / group, limit_file, used_file, cached);
    if (left) least = std::min(*left, least.value_or(*left));
    if (group.empty()) return least;
  }
}

}  // namespace

std::uint64_t available_memory(const fs::path& root) {
  constexpr std::uint64_t kUnknown = std::uint64_t{1} << 30;
  const auto kibibytes = number_after(root / "proc/meminfo", "MemAvailable");
  std::uint64_t available = kibibytes ? *kibibytes * 1024 : kUnknown;
  const auto version2 =
      left_in_groups(root / "sys/fs/cgroup", group_path(root, "::"), "memory.max", "memory.current", "inactive_file");
  const auto version1 = left_in_groups(root / "sys/fs/cgroup/memory", group_path(root, ":memory:"),
                                       "memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file");
  if (version2) available = std::min(available, *version2);
  if (version1) available = std::min(available, *version1);
  return available;
}

}  // namespace pointsweep
