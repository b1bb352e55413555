// SPDX-License-Identifier: MIT
#include "pointsweep/order/spill_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "pointsweep/error.h"
#include "pointsweep/order/temp_folder.h"

namespace pointsweep {
namespace {

[[noreturn]] void fail_write(const std::string& folder, int error, std::uint64_t needed) {
  if (error == ENOSPC || error == EDQUOT)
    fail(
        "no space left in the temporary folder '{}', where {} bytes or more are needed: free some there or name "
        "another folder with --temp-dir.",
        folder, needed);
  if (error == EFBIG)
    fail(
        "a temporary file in '{}' may not grow to {} bytes: raise the limit on file sizes (ulimit -f) or name a "
        "folder of another file system with --temp-dir.",
        folder, needed);
  fail("cannot write to the temporary folder '{}': {}; name another folder with --temp-dir.", folder,
       std::strerror(error));
}

}  // namespace

SpillFile::SpillFile(const TempFolder& folder) : parent_(folder.path().parent_path().string()) {
  std::string name = (folder.path() / "spill-XXXXXX").string();
  descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor_ < 0) fail_write(parent_, errno, 0);
  ::unlink(name.c_str());
}

SpillFile::~SpillFile() { ::close(descriptor_); }

void SpillFile::write(std::uint64_t offset, std::span<const std::byte> bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n =
        ::pwrite(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail_write(parent_, n < 0 ? errno : ENOSPC, reserved_.load());
    done += static_cast<std::size_t>(n);
  }
  written_.fetch_add(bytes.size(), std::memory_order_relaxed);
}

void SpillFile::read(std::uint64_t offset, std::span<std::byte> bytes) const {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::pread(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0)
      fail(
          "cannot read back byte {} of a temporary file in '{}': {}; check that disk or name another folder with "
          "--temp-dir.",
          offset + done, parent_, n < 0 ? std::strerror(errno) : "the file is shorter than what was written");
    done += static_cast<std::size_t>(n);
  }
}

void SpillFile::discard(std::uint64_t offset, std::uint64_t bytes) {
#ifdef FALLOC_FL_PUNCH_HOLE
  (void)::fallocate(descriptor_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(offset),
                    static_cast<off_t>(bytes));
#else
  (void)offset, (void)bytes;
#endif
}

}  // namespace pointsweep
