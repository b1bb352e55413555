// SPDX-License-Identifier: MIT
#include "pointsweep/storage/local/spill_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "pointsweep/fail.h"
#include "pointsweep/storage/local/temp_folder.h"
#include "pointsweep/storage/local/unfinished_output.h"

namespace pointsweep {
namespace {

[[noreturn]] void fail_write(const std::string& folder, const std::string& option, int error, std::uint64_t needed) {
  if (error == ENOSPC || error == EDQUOT)
    fail(
        "no space left in the temporary folder '{}', where {} bytes or more are needed: free some there or name "
        "another folder with {}.",
        folder, needed, option);
  if (error == EFBIG)
    fail(
        "a temporary file in '{}' may not grow to {} bytes: raise the limit on file sizes (ulimit -f) or name a "
        "folder of another file system with {}.",
        folder, needed, option);
  fail("cannot write to the temporary folder '{}': {}; name another folder with {}.", folder, std::strerror(error),
       option);
}

}  // namespace

SpillPlace::SpillPlace(const TempFolder* folder) {
  if (folder != nullptr) folder_ = folder->path();
}

SpillPlace SpillPlace::kept(const std::filesystem::path& file) {
  SpillPlace place(nullptr);
  place.folder_ = file.parent_path();
  place.name_ = file.filename().string();
  return place;
}

SpillFile::SpillFile(const SpillPlace& place)
    : parent_((place.is_kept() ? place.folder() : place.folder().parent_path()).string()),
      option_(place.is_kept() ? "--resume" : "--temp-dir") {
  if (place.is_kept()) {
    file_ = FileDescriptor(::open(place.file().c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
    if (!file_) fail_write(parent_, option_, errno, 0);
    return;
  }
  const std::string name = random_name((place.folder() / "spill-").string());
  const Leftover listed(name);
  file_ = FileDescriptor(::open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  if (!file_) fail_write(parent_, option_, errno, 0);
  ::unlink(name.c_str());
}

SpillFile::SpillFile(const SpillPlace& place, std::uint64_t bytes)
    : parent_(place.folder().string()),
      option_("--resume"),
      file_(::open(place.file().c_str(), O_RDWR | O_CLOEXEC)),
      reserved_(bytes) {
  struct stat status {};
  const bool found = file_ && ::fstat(file_.number(), &status) == 0;
  if (found && static_cast<std::uint64_t>(status.st_size) >= bytes) {
    // The file may be longer than the checkpoint states: the last bytes were written after the checkpoint.
    if (::ftruncate(file_.number(), static_cast<off_t>(bytes)) == 0) return;
  }
  fail("'{}' is not as the last checkpoint left it: remove the folder '{}' and start again.", place.file().string(),
       parent_);
}

void SpillFile::write(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (const int error = file_.write_at(offset, bytes)) fail_write(parent_, option_, error, reserved_.load());
  written_.fetch_add(bytes.size(), std::memory_order_relaxed);
}

void SpillFile::read(std::uint64_t offset, std::span<std::byte> bytes) const {
  const auto [done, error] = file_.read_at(offset, bytes);
  if (done < bytes.size())
    fail("cannot read back byte {} of a temporary file in '{}': {}; check that disk or name another folder with {}.",
         offset + done, parent_, error != 0 ? std::strerror(error) : "the file is shorter than what was written",
         option_);
}

void SpillFile::expect_scattered_reads() const { ::posix_fadvise(file_.number(), 0, 0, POSIX_FADV_RANDOM); }

void SpillFile::will_read(std::uint64_t offset, std::uint64_t bytes) const {
  ::posix_fadvise(file_.number(), static_cast<off_t>(offset), static_cast<off_t>(bytes), POSIX_FADV_WILLNEED);
}

}  // namespace pointsweep
