// SPDX-License-Identifier: MIT
#include "pointsweep/formats/files/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/formats/files/standard_streams.h"

namespace pointsweep {
namespace {

[[noreturn]] void fail_to_open(const std::filesystem::path& path, int error) {
  if (error == ENOENT || error == ENOTDIR) fail("{}: no such file; check the path.", path.string());
  if (error == EACCES || error == EPERM) {
    fail("{}: no permission to read it; change its permissions or copy it to where you may read it.", path.string());
  }
  if (error == EMFILE || error == ENFILE) {
    fail("{}: cannot be opened, since too many files are open; allow more first ('ulimit -n 100000').", path.string());
  }
  fail("{}: cannot be opened: {}.", path.string(), std::generic_category().message(error));
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& path) : path_(path) {
  // O_NONBLOCK: opening a pipe would wait for a writer; it has no effect on regular files.
  const bool is_stream = is_standard_stream(path) && standard_input_descriptor() >= 0;
  descriptor_ = is_stream ? ::fcntl(standard_input_descriptor(), F_DUPFD_CLOEXEC, 0)
                          : ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor_ < 0) fail_to_open(path, errno);
  struct stat status {};
  const bool known = ::fstat(descriptor_, &status) == 0;
  if (known && S_ISREG(status.st_mode)) {
    size_ = static_cast<std::uint64_t>(status.st_size);
    ::posix_fadvise(descriptor_, 0, 0, POSIX_FADV_SEQUENTIAL);
    return;
  }
  ::close(descriptor_);
  if (known && S_ISDIR(status.st_mode)) fail("{}: is a folder, not a file; name the files in it.", path.string());
  fail("{}: is no regular file, and points are read more than once; save it to a file first.", path.string());
}

InputFile::~InputFile() { ::close(descriptor_); }

void InputFile::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  if (read_some(offset, bytes) < bytes.size()) {
    fail("{}: ends before byte {}; it has become shorter since it was opened, so run again once it is complete.",
         path_.string(), offset + bytes.size());
  }
}

std::size_t InputFile::read_some(std::uint64_t offset, std::span<std::byte> bytes) const {
  stop_if_cancelled();
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got =
        ::pread(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (got == 0) break;
    if (got > 0) {
      done += static_cast<std::size_t>(got);
    } else if (errno != EINTR) {
      fail("{}: cannot be read at byte {}: {}; check the disk or the network it lies on.", path_.string(),
           offset + done, std::generic_category().message(errno));
    }
  }
  return done;
}

}  // namespace pointsweep
