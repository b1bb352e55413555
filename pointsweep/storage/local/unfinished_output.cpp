// SPDX-License-Identifier: MIT
#include "pointsweep/storage/local/unfinished_output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>

#include "pointsweep/storage/local/descriptor.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

/// The name of a file that says for which output, and by which process, it was begun.
struct Part {
  std::string output;
  pid_t owner = 0;
};

std::optional<Part> parse_part(std::string_view name) {
  constexpr std::string_view kSuffix = ".part";
  if (!name.starts_with('.') || !name.ends_with(kSuffix)) return {};
  name = name.substr(1, name.size() - 1 - kSuffix.size());
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos || dot == 0) return {};
  Part part{.output = std::string(name.substr(0, dot))};
  const char* const end = name.data() + name.size();
  const auto parsed = std::from_chars(name.data() + dot + 1, end, part.owner);
  if (parsed.ec != std::errc{} || parsed.ptr != end || part.owner <= 0) return {};
  return part;
}

/// A file whose process is gone, or that an earlier process with our number left: no process holds its lock.
bool is_abandoned(const fs::path& part, pid_t owner) {
  if (owner != ::getpid() && (::kill(owner, 0) == 0 || errno != ESRCH)) return false;
  const FileDescriptor file(::open(part.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW));
  return file && lock(file) != EWOULDBLOCK;
}

/// Removes the abandoned parts of the outputs of these names.
void remove_abandoned(const fs::path& folder, const std::set<std::string>& outputs) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const auto part = parse_part(entry->path().filename().string());
    std::error_code ignored;
    if (part && outputs.contains(part->output) && is_abandoned(entry->path(), part->owner))
      fs::remove(entry->path(), ignored);
  }
}

/// The targets of all ManyOutputs that there are.
struct Cleared {
  std::mutex mutex;
  std::multiset<fs::path> targets;
};
Cleared& cleared() {
  static Cleared instance;
  return instance;
}

}  // namespace

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

fs::path target_of(const fs::path& destination) {
  std::error_code error;
  if (!fs::is_symlink(destination, error)) return destination;
  const fs::path target = fs::canonical(destination, error);
  return error ? destination : target;
}

fs::path part_of(const fs::path& target) {
  return folder_of(target) / fmt::format(".{}.{}.part", target.filename().string(), ::getpid());
}

void remove_abandoned_parts(const fs::path& target) {
  {
    const std::lock_guard lock(cleared().mutex);
    if (cleared().targets.contains(target)) return;
  }
  remove_abandoned(folder_of(target), {target.filename().string()});
}

ManyOutputs::ManyOutputs(const std::vector<fs::path>& destinations) {
  std::map<fs::path, std::set<std::string>> names;  // by folder
  for (const fs::path& destination : destinations) {
    targets_.push_back(target_of(destination));
    names[folder_of(targets_.back())].insert(targets_.back().filename().string());
  }
  for (const auto& [folder, outputs] : names) remove_abandoned(folder, outputs);
  const std::lock_guard lock(cleared().mutex);
  cleared().targets.insert(targets_.begin(), targets_.end());
}

ManyOutputs::~ManyOutputs() {
  const std::lock_guard lock(cleared().mutex);
  for (const fs::path& target : targets_) cleared().targets.erase(cleared().targets.find(target));
}

}  // namespace pointsweep
