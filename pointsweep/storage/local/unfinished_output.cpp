// SPDX-License-Identifier: MIT
#include "pointsweep/storage/local/unfinished_output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>

#include "pointsweep/number_from.h"
#include "pointsweep/program/process.h"
#include "pointsweep/storage/local/descriptor.h"
#include "pointsweep/storage/remote/url.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

enum class EntryState : unsigned char { free, changing, listed };

/// An entry of the list of leftovers. It has a fixed address, so a signal handler can read the name even if other
/// threads change the list.
struct ListEntry {
  std::atomic<EntryState> state = EntryState::free;
  std::array<char, 4096> name{};
};
static_assert(std::atomic<EntryState>::is_always_lock_free);

std::array<ListEntry, 64> entries;

/// The parts of the name of an incomplete output: the name of the output, and the process that has begun it.
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
  const auto owner = number_from<pid_t>(name.substr(dot + 1));
  if (!owner || *owner <= 0) return {};
  return Part{std::string(name.substr(0, dot)), *owner};
}

/// Returns whether no process writes the file. No process may have locked the file. In addition, process `owner` must
/// have ended, or have the number of this process, since an earlier process may have had this number.
bool is_abandoned(const fs::path& part, pid_t owner) {
  if (owner != ::getpid() && (::kill(owner, 0) == 0 || errno != ESRCH)) return false;
  const FileDescriptor file(::open(part.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW));
  return file && lock(file) != EWOULDBLOCK;
}

/// Removes the abandoned files in the folder that belong to outputs for which is_output(name) is true.
template <class IsOutput>
void remove_abandoned(const fs::path& folder, const IsOutput& is_output) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const auto part = parse_part(entry->path().filename().string());
    std::error_code ignored;
    if (part && is_output(part->output) && is_abandoned(entry->path(), part->owner)) fs::remove(entry->path(), ignored);
  }
}

std::size_t hash_of(const fs::path& folder, const std::string& name) {
  return std::hash<std::string>{}(folder.string() + '/' + name);
}

/// The list of all existing ManyOutputs, and its lock.
struct Cleared {
  std::mutex mutex;
  std::set<const ManyOutputs*> outputs;
};
Cleared& cleared() {
  static Cleared instance;
  return instance;
}

/// Returns whether a ManyOutputs has already removed abandoned files of the output with this name in the folder.
bool is_cleared(const fs::path& folder, const std::string& name) {
  const std::lock_guard lock(cleared().mutex);
  return std::ranges::any_of(cleared().outputs, [&](const ManyOutputs* many) { return many->has(folder, name); });
}

}  // namespace

Leftover::Leftover(const std::filesystem::path& path) {
  const std::string name = path.string();
  if (name.size() >= entries[0].name.size()) return;
  for (std::size_t i = 0; i < entries.size() && place_ == kNone; ++i) {
    EntryState expected = EntryState::free;
    if (!entries[i].state.compare_exchange_strong(expected, EntryState::changing)) continue;
    std::memcpy(entries[i].name.data(), name.c_str(), name.size() + 1);
    entries[i].state = EntryState::listed;
    place_ = i;
  }
}

void Leftover::forget() noexcept {
  if (place_ != kNone) entries[place_].state = EntryState::free;
  place_ = kNone;
}

/// Removes files first, so that folders are empty.
void remove_leftovers() noexcept {
  const int before = errno;
  for (const auto remove : {::unlink, ::rmdir})
    for (const ListEntry& entry : entries)
      if (entry.state == EntryState::listed) remove(entry.name.data());
  errno = before;
}

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
  const fs::path folder = folder_of(target);
  const std::string own = target.filename().string();
  if (is_cleared(folder, own)) return;
  remove_abandoned(folder, [&](const std::string& name) { return name == own; });
}

ManyOutputs::ManyOutputs(std::size_t count, const std::function<fs::path(std::size_t)>& destination) {
  std::set<fs::path> folders;
  targets_.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (is_url(destination(i))) continue;
    const fs::path target = target_of(destination(i)), folder = folder_of(target);
    targets_.push_back(hash_of(folder, target.filename().string()));
    if (!is_cleared(folder, target.filename().string())) folders.insert(folder);
  }
  std::ranges::sort(targets_);
  for (const fs::path& folder : folders)
    remove_abandoned(folder, [&](const std::string& name) { return has(folder, name); });
  const std::lock_guard lock(cleared().mutex);
  cleared().outputs.insert(this);
}

ManyOutputs::ManyOutputs(std::vector<std::size_t> targets) : targets_(std::move(targets)) {
  const std::lock_guard lock(cleared().mutex);
  cleared().outputs.insert(this);
}

ManyOutputs ManyOutputs::listed_by_caller(const std::vector<fs::path>& destinations) {
  std::vector<std::size_t> targets;
  for (const fs::path& destination : destinations) {
    if (is_url(destination)) continue;
    const fs::path target = target_of(destination);
    targets.push_back(hash_of(folder_of(target), target.filename().string()));
  }
  std::ranges::sort(targets);
  return ManyOutputs(std::move(targets));
}

ManyOutputs::~ManyOutputs() {
  const std::lock_guard lock(cleared().mutex);
  cleared().outputs.erase(this);
}

bool ManyOutputs::has(const fs::path& folder, const std::string& name) const {
  return std::ranges::binary_search(targets_, hash_of(folder, name));
}

}  // namespace pointsweep
