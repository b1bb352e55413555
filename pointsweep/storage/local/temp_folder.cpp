// SPDX-License-Identifier: MIT
#include "pointsweep/storage/local/temp_folder.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "pointsweep/fail.h"
#include "pointsweep/math/mix.h"

namespace pointsweep {
namespace {

constexpr std::string_view kPrefix = "pointsweep-";
constexpr std::size_t kRandomLetters = 6;

/// Returns the number of the process that made a folder with this name; nothing if it is not the name of a TempFolder.
std::optional<pid_t> maker_of(std::string_view name) {
  if (!name.starts_with(kPrefix)) return {};
  name.remove_prefix(kPrefix.size());
  pid_t pid = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), pid);
  const std::string_view rest = name.substr(static_cast<std::size_t>(end - name.data()));
  if (error != std::errc() || pid <= 0 || rest.size() != 1 + kRandomLetters || rest[0] != '-') return {};
  return pid;
}

bool is_alive(pid_t pid) { return ::kill(pid, 0) == 0 || errno != ESRCH; }

/// Removes a folder of this user unless a process has locked it. The lock protects folders of processes that this
/// process cannot see, such as processes in another container on the same disk.
void remove_if_abandoned(const std::filesystem::path& path) {
  const FileDescriptor folder = open_folder(path, false);
  if (!folder) return;
  struct stat status {};
  const bool ours = ::fstat(folder.number(), &status) == 0 && status.st_uid == ::geteuid();
  std::error_code ignored;
  if (ours && lock(folder) == 0) std::filesystem::remove_all(path, ignored);
}

void remove_abandoned_folders(const std::filesystem::path& parent) {
  std::error_code error;
  for (std::filesystem::directory_iterator entry(parent, error), end; !error && entry != end; entry.increment(error)) {
    const std::optional<pid_t> pid = maker_of(entry->path().filename().string());
    if (pid && !is_alive(*pid)) remove_if_abandoned(entry->path());
  }
}

}  // namespace

void require_temp_parent(const std::filesystem::path& parent) {
  struct stat status {};
  const char* why = nullptr;
  if (::stat(parent.c_str(), &status) != 0)
    why = std::strerror(errno);
  else if (!S_ISDIR(status.st_mode))
    why = "it is not a folder";
  else if (::faccessat(AT_FDCWD, parent.c_str(), W_OK | X_OK, AT_EACCESS) != 0)
    why = std::strerror(errno);
  if (why != nullptr)
    fail("the temporary folder '{}' cannot be used: {}; name a writable folder with --temp-dir.", parent.string(), why);
}

std::filesystem::path temp_parent(const std::filesystem::path& asked) {
  return asked.empty() ? std::filesystem::temp_directory_path() : asked;
}

std::string random_name(const std::string& begin) {
  static std::atomic<std::uint64_t> made = 0;
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz0123456789";
  const auto now = static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
  std::uint64_t number = mix(now ^ mix(static_cast<std::uint64_t>(::getpid()) ^ mix(++made)));
  std::string name = begin;
  for (std::size_t i = 0; i < kRandomLetters; ++i, number /= kLetters.size())
    name += kLetters[number % kLetters.size()];
  return name;
}

TempFolder::TempFolder(const std::filesystem::path& parent) {
  remove_abandoned_folders(parent);
  const std::string begin = (parent / std::string(kPrefix)).string() + std::to_string(::getpid()) + "-";
  do {
    path_ = random_name(begin);
    leftover_.emplace(path_);
    if (::mkdir(path_.c_str(), 0700) == 0) break;
    const int error = errno;
    leftover_.reset();
    if (error != EEXIST)
      fail("cannot make a temporary folder in '{}': {}; name a writable folder with --temp-dir.", parent.string(),
           std::strerror(error));
  } while (true);
  lock_ = open_folder(path_, false);
  lock(lock_);  // a failure is ignored, since some file systems have no locks
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace pointsweep
