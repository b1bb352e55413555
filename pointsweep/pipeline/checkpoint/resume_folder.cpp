// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/checkpoint/resume_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <system_error>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCheckpoint = "checkpoint";
constexpr const char* kNext = "checkpoint.new";
constexpr std::array<char, 8> kMagic = {'P', 'S', 'W', 'C', 'K', 'P', 'T', '1'};

struct Head {
  std::array<char, 8> magic = kMagic;
  std::uint64_t bytes = 0, checksum = 0;
};

/// FNV-1a over words of eight bytes.
std::uint64_t checksum(std::span<const std::byte> bytes) {
  std::uint64_t sum = 0xcbf29ce484222325;
  for (std::size_t at = 0; at < bytes.size(); at += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + at, std::min<std::size_t>(8, bytes.size() - at));
    sum = (sum ^ word) * 0x100000001b3;
    sum ^= sum >> 32;
  }
  return sum;
}

bool is_data(const std::string& name) {
  return name.starts_with("stream-") || name.starts_with("results-") || name.starts_with("rows-") ||
         name.starts_with("mask-") || name.starts_with("decoded-");
}

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    names.push_back(entry->path().filename().string());
  return names;
}

[[noreturn]] void fail_to_write(const fs::path& folder, int error) {
  fail("cannot write a checkpoint into '{}': {}; free space there or name another folder with --resume.",
       folder.string(), std::strerror(error));
}

/// A file being written, closed whatever happens.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  explicit operator bool() const { return number_ >= 0; }
  bool write(const void* from, std::size_t size) const {
    const auto* bytes = static_cast<const char*>(from);
    while (size > 0) {
      const ssize_t n = ::write(number_, bytes, size);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return false;
      bytes += n;
      size -= static_cast<std::size_t>(n);
    }
    return true;
  }
  bool sync() const { return ::fdatasync(number_) == 0; }

 private:
  int number_;
};

}  // namespace

ResumeFolder::ResumeFolder(const fs::path& path) : path_(path) {
  if (::mkdir(path.c_str(), 0700) != 0 && errno != EEXIST)
    fail("cannot make the folder '{}': {}; name a place where that is possible with --resume.", path.string(),
         std::strerror(errno));
  lock_ = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0) fail("'{}' is no folder that can be used: {}.", path.string(), std::strerror(errno));
  try {
    if (::flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
      fail("another run is working in '{}'; wait for it, or name another folder with --resume.", path.string());
    load();
  } catch (...) {
    ::close(lock_);
    throw;
  }
}

ResumeFolder::~ResumeFolder() {
  if (saving_.valid()) saving_.wait();
  if (!holds_work_) remove();
  ::close(lock_);
}

void ResumeFolder::load() {
  for (const std::string& name : names_in(path_)) {
    if (name == kCheckpoint) holds_work_ = true;
    if (name != kCheckpoint && name != kNext && name != kTiles && !is_data(name))
      fail("'{}' holds '{}', which no run to be resumed has left; name an empty or a new folder with --resume.",
           path_.string(), name);
  }
  if (!holds_work_) return forget();
  const InputFile file(path_ / kCheckpoint);
  Head head;
  if (file.size() >= sizeof head) file.read_at(0, std::as_writable_bytes(std::span(&head, 1)));
  if (head.magic == kMagic && file.size() >= sizeof head && head.bytes == file.size() - sizeof head) {
    saved_.resize(head.bytes);
    file.read_at(sizeof head, saved_);
    if (checksum(saved_) == head.checksum) return;
  }
  fail("'{}' is damaged: remove the folder and start again.", (path_ / kCheckpoint).string());
}

void ResumeFolder::save(std::vector<std::byte> bytes, const std::set<std::string>& names) {
  if (saving_.valid()) saving_.get();
  saving_ = std::async(std::launch::async, [this, bytes = std::move(bytes), names, others = others_than(names)] {
    sync(names);
    {
      const std::lock_guard lock(removal_);
      if (removing_) return;
      write(bytes);
      holds_work_ = true;
    }
    std::error_code ignored;
    for (const std::string& name : others) fs::remove(path_ / name, ignored);
  });
}

bool ResumeFolder::is_saving() const {
  return saving_.valid() && saving_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
}

void ResumeFolder::sync(const std::set<std::string>& names) const {
  for (const std::string& name : names) {
    const Descriptor file(::open((path_ / name).c_str(), O_RDWR | O_CLOEXEC));
    if (!file || !file.sync()) fail_to_write(path_, errno);
  }
}

void ResumeFolder::write(std::span<const std::byte> bytes) const {
  const fs::path next = path_ / kNext;
  const Head head{kMagic, bytes.size(), checksum(bytes)};
  {
    const Descriptor file(::open(next.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
    if (!file || !file.write(&head, sizeof head) || !file.write(bytes.data(), bytes.size()) || !file.sync())
      fail_to_write(path_, errno);
  }
  if (::rename(next.c_str(), (path_ / kCheckpoint).c_str()) != 0) fail_to_write(path_, errno);
  ::fsync(lock_);  // best effort: some file systems know no such thing of folders
}

std::vector<std::string> ResumeFolder::others_than(const std::set<std::string>& names) const {
  std::vector<std::string> others = names_in(path_);
  std::erase_if(others, [&](const std::string& name) { return !is_data(name) || names.contains(name); });
  return others;
}

void ResumeFolder::keep_only(const std::set<std::string>& names) const {
  std::error_code ignored;
  fs::remove(path_ / kNext, ignored);
  for (const std::string& name : others_than(names)) fs::remove(path_ / name, ignored);
}

void ResumeFolder::forget() const {
  std::error_code ignored;
  fs::remove(path_ / kTiles, ignored);
  keep_only({});
}

/// The checkpoint goes first, for good: without it nothing in the folder is of use to anybody.
void ResumeFolder::remove() {
  std::error_code ignored;
  {
    const std::lock_guard lock(removal_);
    removing_ = true;
    fs::remove(path_ / kCheckpoint, ignored);
  }
  if (is_saving())  // what is not on the disk yet need not go there
    for (const std::string& name : others_than({})) fs::resize_file(path_ / name, 0, ignored);
  if (saving_.valid()) saving_.wait();
  forget();
  ::rmdir(path_.c_str());
}

}  // namespace pointsweep
