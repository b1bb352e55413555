// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/available_memory.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace pointsweep {
namespace {

/// Names of the files of control groups of one version.
struct GroupFiles {
  const char* root;  ///< folder of the outermost group
  const char* limit;
  const char* usage;
  std::array<const char*, 2> file_pages;  ///< words in memory.stat before the bytes of pages of files
};

constexpr GroupFiles kVersion1{"sys/fs/cgroup/memory",
                               "memory.limit_in_bytes",
                               "memory.usage_in_bytes",
                               {"total_active_file", "total_inactive_file"}};
constexpr GroupFiles kVersion2{"sys/fs/cgroup", "memory.max", "memory.current", {"active_file", "inactive_file"}};

/// Returns the number that follows `word` in the file; the first number of the file if `word` is empty. Absent if there
/// is none, as in "max", or no file.
std::optional<std::uint64_t> number_in(const std::filesystem::path& path, std::string_view word = {}) {
  std::ifstream file(path);
  for (std::string found; !word.empty() && found != word;)
    if (!(file >> found)) return std::nullopt;
  std::uint64_t number = 0;
  return file >> number ? std::optional(number) : std::nullopt;
}

/// Returns the number of bytes that the processes of a group may still allocate; the largest number if the group has no
/// limit.
std::uint64_t left_in_group(const std::filesystem::path& folder, const GroupFiles& files) {
  const std::optional<std::uint64_t> limit = number_in(folder / files.limit);
  if (!limit) return std::numeric_limits<std::uint64_t>::max();
  const std::uint64_t usage = number_in(folder / files.usage).value_or(0);
  std::uint64_t of_files = 0;
  for (const char* const word : files.file_pages) of_files += number_in(folder / "memory.stat", word).value_or(0);
  return *limit - std::min(*limit, usage - std::min(usage, of_files));
}

/// Returns the least number of bytes left in `group`, a path such as "/jobs/7", and in the groups around it. In a
/// container, the path may be one of the host, whose folders do not exist here.
std::uint64_t left_in_groups(const std::filesystem::path& root, const GroupFiles& files, std::filesystem::path group) {
  std::uint64_t left = left_in_group(root / files.root, files);
  for (; group.has_relative_path(); group = group.parent_path())
    left = std::min(left, left_in_group(root / files.root / group.relative_path(), files));
  return left;
}

}  // namespace

std::uint64_t available_memory(const std::filesystem::path& root) {
  constexpr std::uint64_t kUnknown = std::uint64_t{1} << 30;
  const std::optional<std::uint64_t> kilobytes = number_in(root / "proc/meminfo", "MemAvailable:");
  std::uint64_t available = kilobytes ? *kilobytes * 1024 : kUnknown;
  // A line is "4:memory:/jobs/7" in version 1 and "0::/jobs/7" in version 2.
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == line.npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const bool is_version2 = controllers == ",,";
    if (!is_version2 && controllers.find(",memory,") == controllers.npos) continue;
    available = std::min(available, left_in_groups(root, is_version2 ? kVersion2 : kVersion1, line.substr(second + 1)));
  }
  return available;
}

std::uint64_t memory_budget(std::uint64_t asked_for) { return asked_for != 0 ? asked_for : available_memory() / 2; }

}  // namespace pointsweep
