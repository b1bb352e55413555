// SPDX-License-Identifier: MIT
#include "pointsweep/storage/local/input_file.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <mutex>
#include <system_error>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/program/standard_streams.h"
#include "pointsweep/storage/remote/url.h"

namespace pointsweep {
namespace {

[[noreturn]] void fail_to_open(const std::filesystem::path& path, int error) {
  if (path.empty()) fail("a file to read has an empty name; name a file.");
  if (error == ENOENT || error == ENOTDIR) fail("{}: no such file; check the path.", path.string());
  if (error == EACCES || error == EPERM) {
    fail("{}: no permission to read it; change its permissions or copy it to where you may read it.", path.string());
  }
  if (error == EMFILE || error == ENFILE) {
    fail("{}: cannot be opened, since too many files are open; allow more first ('ulimit -n 100000').", path.string());
  }
  fail("{}: cannot be opened: {}.", path.string(), std::generic_category().message(error));
}

/// Opens a file, or another descriptor of the file that is the standard input.
FileDescriptor opened(const std::filesystem::path& path) {
  const bool is_stream = is_standard_stream(path) && standard_input_descriptor() >= 0;
  // O_NONBLOCK: opening a pipe would wait for a writer. It has no effect on regular files.
  FileDescriptor file(is_stream ? ::fcntl(standard_input_descriptor(), F_DUPFD_CLOEXEC, 0)
                                : ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file) fail_to_open(path, errno);
  return file;
}

/// The list of all InputFiles of this process that are open, most recently read first, and its lock.
struct OpenFilesOfProcess {
  std::mutex mutex;
  std::list<const InputFile*> files;
};

OpenFilesOfProcess& open_files() {
  static OpenFilesOfProcess all;
  return all;
}

std::size_t most_open_files() {
  constexpr std::size_t kMost = 256;
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return kMost;
  return std::clamp<std::size_t>(static_cast<std::size_t>(limit.rlim_cur / 4), 1, kMost);
}

}  // namespace

/// Keeps a file open while it is read.
class InputFile::Lease {
 public:
  explicit Lease(const InputFile& file) : file_(file) {
    OpenFilesOfProcess& all = open_files();
    const std::lock_guard lock(all.mutex);
    if (!file.file_)
      file.reopen();
    else
      all.files.splice(all.files.begin(), all.files, file.place_);
    ++file.leases_;
  }
  ~Lease() {
    const std::lock_guard lock(open_files().mutex);
    --file_.leases_;
  }
  Lease(const Lease&) = delete;
  Lease& operator=(const Lease&) = delete;

 private:
  const InputFile& file_;
};

/// Closes files that no thread reads, until one more file may be opened. The caller holds the lock of the open files.
void InputFile::close_idle_files() {
  static const std::size_t most = most_open_files();
  OpenFiles& files = open_files().files;
  for (auto file = files.end(); files.size() >= most && file != files.begin();) {
    --file;
    if ((*file)->leases_ > 0) continue;
    (*file)->file_.close();
    file = files.erase(file);
  }
}

InputFile::InputFile(const std::filesystem::path& path) : path_(path) {
  if (is_url(path_)) {
    object_ = RemoteObject::open(path_);
    size_ = object_->version().size;
    return;
  }
  const std::lock_guard lock(open_files().mutex);
  close_idle_files();
  FileDescriptor file = opened(path);
  struct stat status {};
  const bool known = ::fstat(file.number(), &status) == 0;
  if (known && S_ISREG(status.st_mode)) {
    size_ = static_cast<std::uint64_t>(status.st_size);
    device_ = static_cast<std::uint64_t>(status.st_dev);
    inode_ = static_cast<std::uint64_t>(status.st_ino);
    keep_open(std::move(file));
    return;
  }
  if (known && S_ISDIR(status.st_mode)) fail("{}: is a folder, not a file; name the files in it.", path.string());
  fail("{}: is no regular file, and points are read more than once; save it to a file first.", path.string());
}

/// Opens the file again after close_idle_files() has closed it. The caller holds the lock of the open files.
void InputFile::reopen() const {
  close_idle_files();
  FileDescriptor file = opened(path_);
  struct stat status {};
  const bool known = ::fstat(file.number(), &status) == 0;
  if (!known || static_cast<std::uint64_t>(status.st_dev) != device_ ||
      static_cast<std::uint64_t>(status.st_ino) != inode_)
    fail("{}: was replaced by another file while it was read; run again when no other program writes there.", path_);
  keep_open(std::move(file));
}

/// Adds this file to the list of open files. The caller holds the lock of the open files.
void InputFile::keep_open(FileDescriptor file) const {
  ::posix_fadvise(file.number(), 0, 0, POSIX_FADV_SEQUENTIAL);
  file_ = std::move(file);
  place_ = open_files().files.insert(open_files().files.begin(), this);
}

InputFile::~InputFile() {
  if (object_) return;
  const std::lock_guard lock(open_files().mutex);
  if (file_) open_files().files.erase(place_);
}

void InputFile::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  if (read_some(offset, bytes) < bytes.size()) {
    fail("{}: ends before byte {}; it has become shorter since it was opened, so run again once it is complete.", path_,
         offset + bytes.size());
  }
}

void InputFile::will_read(std::uint64_t begin, std::uint64_t end) const {
  if (object_) object_->will_read(begin, end);
}

std::size_t InputFile::read_some(std::uint64_t offset, std::span<std::byte> bytes) const {
  stop_if_cancelled();
  if (object_) return object_->read_some(offset, bytes);
  const Lease lease(*this);
  const auto [done, error] = file_.read_at(offset, bytes);
  if (error != 0)
    fail("{}: cannot be read at byte {}: {}; check the disk or the network it lies on.", path_, offset + done,
         std::generic_category().message(error));
  return done;
}

}  // namespace pointsweep
