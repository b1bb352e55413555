// SPDX-License-Identifier: MIT
#include "pointsweep/storage/local/output_file.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cassert>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/program/process.h"
#include "pointsweep/program/standard_streams.h"
#include "pointsweep/program/whole_file.h"
#include "pointsweep/storage/local/temp_folder.h"
#include "pointsweep/storage/local/unfinished_output.h"
#include "pointsweep/storage/remote/remote_service.h"
#include "pointsweep/storage/remote/url.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

std::atomic<bool> any_complete = false, any_streamed = false, reader_ended = false;
std::atomic<int> incomplete_files = 0;  ///< number of incomplete outputs, without standard output

[[noreturn]] void fail_since_it_exists(const fs::path& destination) {
  fail("{}: exists already; choose another name, or allow it to be replaced (--force).", destination.string());
}

/// Throws Error if no output to the URL is possible. With `overwrite`, does not ask the server whether the object
/// exists, because a user who may only write cannot see the object.
void check_url(const fs::path& destination, bool overwrite) {
  const std::string& url = destination.native();
  require_writable_url(url);
  if (!destination.has_filename()) fail("'{}' names no file to write.", url);
  if (!overwrite && look_at(url)) fail_since_it_exists(destination);
}

[[noreturn]] void fail_to_write_to(const fs::path& destination, int error) {
  const std::string name = destination.string();
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      fail("{}: no space left in {}; free some or write to another disk (nothing was left behind).", name,
           folder_of(destination).string());
    case EACCES:
    case EPERM:
      fail("{}: no permission to write in {}; choose another folder.", name, folder_of(destination).string());
    case EROFS:
      fail("{}: {} is read-only; choose another folder.", name, folder_of(destination).string());
    case EPIPE:
      reader_ended = incomplete_files == 0;
      fail("{}: the program that reads standard output ended before the last point; see what it says.", name);
    case EFBIG:
      fail("{}: has become larger than its file system or a limit (ulimit -f) allows.", name);
    case ENAMETOOLONG:
      fail("{}: its name is too long; choose a shorter one.", name);
    default:
      fail("{}: cannot be written: {}.", name, std::generic_category().message(error));
  }
}

/// Returns whether a path such as /dev/stderr or /dev/fd/3 stands for a stream that is open in this process. Replacing
/// it would replace the file to which the stream goes.
bool is_open_stream(const fs::path& destination) {
  constexpr int kMostLinks = 40;
  std::error_code error;
  fs::path place = destination;
  for (int links = 0; links < kMostLinks; ++links) {
    if (fs::canonical(folder_of(place), error).native().starts_with("/proc/")) return true;
    const fs::path next = fs::read_symlink(place, error);
    if (error) return false;
    place = folder_of(place) / next;
  }
  return false;
}

void check_destination(const fs::path& destination, bool overwrite) {
  if (!destination.has_filename()) fail("'{}' names no file to write.", destination.string());
  std::error_code error;
  const fs::path folder = folder_of(destination);
  const fs::file_status folder_status = fs::status(folder, error);
  if (!fs::exists(folder_status)) {
    fail("{}: the folder {} does not exist; create it first.", destination.string(), folder.string());
  }
  if (!fs::is_directory(folder_status)) fail("{}: {} is no folder.", destination.string(), folder.string());
  const fs::file_status status = fs::symlink_status(destination, error);
  if (fs::is_directory(status)) {
    fail("{}: is a folder; name the file to write in it.", destination.string());
  }
  if (is_open_stream(destination))
    fail("{}: stands for an open stream, which cannot be replaced; name a file.", destination.string());
  if (!fs::exists(status)) return;
  if (!overwrite) fail_since_it_exists(destination);
  if (!fs::is_regular_file(status) && !fs::is_symlink(status)) {
    fail("{}: is no regular file and will not be replaced; choose another name.", destination.string());
  }
}

/// Renames a file, but does not replace a file that has appeared at `to` meanwhile (except in a short moment, on a file
/// system that supports neither renameat2() nor link()). Returns 0 or an errno.
int rename_to_new(const fs::path& from, const fs::path& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  if (::link(from.c_str(), to.c_str()) == 0) return ::unlink(from.c_str()) == 0 ? 0 : errno;
  if (errno == EEXIST) return EEXIST;
  // This file system supports neither call, so a test before the rename has to suffice.
  struct stat status {};
  if (::lstat(to.c_str(), &status) == 0) return EEXIST;
  return ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

}  // namespace

void OutputFile::require_possible(const fs::path& destination, bool overwrite) {
  if (is_url(destination)) return check_url(destination, overwrite);
  check_destination(destination, overwrite);
  const fs::path target = target_of(destination);
  if (target != destination) check_destination(target, overwrite);
}

fs::path OutputFile::unfinished_path(const fs::path& destination) { return part_of(target_of(destination)); }

OutputFile::OutputFile(const fs::path& destination, bool overwrite, const fs::path& temp_folder)
    : destination_(destination),
      overwrite_(overwrite),
      is_stream_(is_standard_output(destination)),
      is_remote_(is_url(destination)) {
  if (is_remote_) {
    open_for_upload(temp_folder);
    return;
  }
  if (is_stream_) {
    destination_ = "-";
    if (::isatty(STDOUT_FILENO) != 0)
      fail("-: standard output is a terminal; redirect it to a file or to a program, or name a file.");
    file_ = FileDescriptor(::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0));
    if (!file_) fail_to_write(errno);
    return;
  }
  require_possible(destination, overwrite);
  destination_ = target_of(destination);
  part_ = part_of(destination_);
  remove_abandoned_parts(destination_);
  leftover_.emplace(part_);
  file_ = FileDescriptor(::open(part_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!file_ && errno == EEXIST) fail("{}: is being written already.", destination_.string());
  if (!file_) fail_to_write(errno);
  ++incomplete_files;
  incomplete_ = true;
  lock(file_);
}

void OutputFile::open_for_upload(const fs::path& temp_folder) {
  require_possible(destination_, overwrite_);
  temp_folder_ = temp_parent(temp_folder);
  file_ = open_nameless(temp_folder_);
  if (!file_) fail_to_write(errno);
  ++incomplete_files;
  incomplete_ = true;
}

void OutputFile::fail_to_write(int error) const {
  if (is_remote_)
    fail(
        "{}: cannot be prepared in the temporary folder '{}': {}; free space there, or name another folder with "
        "--temp-dir.",
        destination_.string(), temp_folder_.string(), std::generic_category().message(error));
  fail_to_write_to(destination_, error);
}

OutputFile::~OutputFile() {
  if (!incomplete_) return;
  if (!part_.empty()) ::unlink(part_.c_str());
  --incomplete_files;
}

void OutputFile::append(std::span<const std::byte> bytes) {
  write_at(size_, bytes);
  size_ += bytes.size();
}

void OutputFile::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (!is_stream_) {
    if (const int error = file_.write_at(offset, bytes)) fail_to_write(error);
    return;
  }
  assert(offset == streamed_ && "bytes come in sequence where the output is no file");
  streamed_ += bytes.size();
  any_streamed = any_streamed || !bytes.empty();
  while (!bytes.empty()) {
    const ssize_t written = write_to_stream(file_.number(), bytes);
    if (written > 0)
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    else if (written == 0 || (errno != EINTR && errno != EAGAIN))
      fail_to_write(written == 0 ? ENOSPC : errno);
  }
}

void OutputFile::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  const auto [done, error] = file_.read_at(offset, bytes);
  if (done < bytes.size())
    fail("{}: what was just written cannot be read back at byte {}: {}; check the disk it lies on.",
         destination_.string(), offset + done, error == 0 ? "the file ends" : std::generic_category().message(error));
}

void OutputFile::seal() {
  if (is_remote_) {
    // A file without a name is opened again by its descriptor.
    upload(destination_.native(), fmt::format("/proc/self/fd/{}", file_.number()), overwrite_);
    file_.close();
  } else {
    if (const int error = file_.close()) fail_to_write(error);
    if (!is_stream_) rename_to_destination();
  }
  if (std::exchange(incomplete_, false)) --incomplete_files;
  leftover_.reset();
  any_complete = true;
}

void OutputFile::rename_to_destination() {
  if (overwrite_) {
    if (::rename(part_.c_str(), destination_.c_str()) != 0) fail_to_write(errno);
  } else if (const int error = rename_to_new(part_, destination_); error != 0) {
    if (error == EEXIST) fail_since_it_exists(destination_);
    fail_to_write(error);
  }
}

OutputsSoFar outputs_so_far() { return {any_complete, any_streamed, reader_ended}; }

WholeFile::WholeFile(const std::filesystem::path& destination, bool overwrite)
    : file_(std::make_unique<OutputFile>(destination, overwrite)) {}

WholeFile::~WholeFile() = default;

void WholeFile::complete(std::span<const std::byte> content) {
  file_->append(content);
  file_->seal();
}

void WholeFile::complete(std::string_view content) { complete(std::as_bytes(std::span(content))); }

}  // namespace pointsweep
