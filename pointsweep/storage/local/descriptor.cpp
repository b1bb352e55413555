// SPDX-License-Identifier: MIT
#include "pointsweep/storage/local/descriptor.h"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/program/standard_streams.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

int standard_input = -1;

std::string text_of(int error) { return std::generic_category().message(error); }

[[noreturn]] void fail_to_hold_input(const fs::path& folder, int error) {
  fail(
      "{}: cannot hold a temporary copy of standard input: {}; free some space, or choose another folder with "
      "--temp-dir.",
      folder.string(), text_of(error));
}

/// Waits until the next read or write does not block. Throws Cancelled within a fraction of a second after a request to
/// stop.
void wait_for(int descriptor, short events) {
  constexpr int kMilliseconds = 100;
  pollfd waiting{.fd = descriptor, .events = events, .revents = 0};
  for (int ready = 0; ready == 0 || (ready < 0 && errno == EINTR);) {
    ready = ::poll(&waiting, 1, kMilliseconds);
    stop_if_cancelled();
  }
}

/// Reads the next bytes of standard input, a pipe, and returns their number; 0 at the end of the pipe.
std::size_t read_pipe(std::span<std::byte> bytes) {
  for (;;) {
    wait_for(STDIN_FILENO, POLLIN);
    const ssize_t got = ::read(STDIN_FILENO, bytes.data(), bytes.size());
    if (got >= 0) return static_cast<std::size_t>(got);
    if (errno != EINTR && errno != EAGAIN) fail("-: standard input cannot be read: {}.", text_of(errno));
  }
}

void write_whole(int file, std::span<const std::byte> bytes, const fs::path& folder) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written > 0)
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    else if (written == 0 || errno != EINTR)
      fail_to_hold_input(folder, written == 0 ? ENOSPC : errno);
  }
}

bool is_regular(int descriptor) {
  struct stat status {};
  return ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

/// Returns whether standard input is a file at its beginning, so that no copy is needed.
bool is_whole_file() { return is_regular(STDIN_FILENO) && ::lseek(STDIN_FILENO, 0, SEEK_CUR) == 0; }

}  // namespace

int FileDescriptor::close() {
  const int number = std::exchange(number_, -1);
  return number < 0 || ::close(number) == 0 || errno == EINTR ? 0 : errno;
}

int FileDescriptor::write_at(std::uint64_t offset, std::span<const std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t n = ::pwrite(number_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return n < 0 ? errno : ENOSPC;
    offset += static_cast<std::uint64_t>(n);
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return 0;
}

FileDescriptor::Got FileDescriptor::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::pread(number_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return {done, errno};
    if (n == 0) break;
    done += static_cast<std::size_t>(n);
  }
  return {done, 0};
}

FileDescriptor open_folder(const std::filesystem::path& path, bool follow_link) {
  return FileDescriptor(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | (follow_link ? 0 : O_NOFOLLOW)));
}

int lock(const FileDescriptor& descriptor) { return ::flock(descriptor.number(), LOCK_EX | LOCK_NB) == 0 ? 0 : errno; }

FileDescriptor open_nameless(const std::filesystem::path& folder) {
  FileDescriptor nameless(::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600));
  if (nameless) return nameless;
  std::string name = (folder / "pointsweep-nameless-XXXXXX").string();  // for a file system without O_TMPFILE
  FileDescriptor named(::mkostemp(name.data(), O_CLOEXEC));
  if (named) ::unlink(name.c_str());
  return named;
}

bool is_standard_stream(const fs::path& path) { return path == "-"; }

bool is_standard_output(const fs::path& path) { return !path.has_parent_path() && path.stem() == "-"; }

int standard_input_descriptor() { return standard_input; }

void take_standard_input(const fs::path& folder) {
  if (standard_input >= 0) return;
  if (::isatty(STDIN_FILENO) != 0) fail("-: standard input is a terminal; redirect a point file to it or name a file.");
  if (is_whole_file()) {
    standard_input = STDIN_FILENO;
    return;
  }
  const fs::path place = folder.empty() ? fs::temp_directory_path() : folder;
  FileDescriptor copy = open_nameless(place);
  if (!copy) fail_to_hold_input(place, errno);
  std::vector<std::byte> block(1 << 20);
  while (const std::size_t got = read_pipe(block)) write_whole(copy.number(), std::span(block).first(got), place);
  static const FileDescriptor kept = std::move(copy);
  standard_input = kept.number();
}

ssize_t write_to_stream(int descriptor, std::span<const std::byte> bytes) {
  constexpr std::size_t kPieceBytes = 4096;  // PIPE_BUF: a pipe that is ready accepts this many bytes without waiting
  if (is_regular(descriptor)) return ::write(descriptor, bytes.data(), bytes.size());
  wait_for(descriptor, POLLOUT);
  return ::write(descriptor, bytes.data(), std::min(bytes.size(), kPieceBytes));
}

}  // namespace pointsweep
