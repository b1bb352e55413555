// SPDX-License-Identifier: MIT
#include "pointsweep/storage/local/file_state.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include "pointsweep/storage/local/standard_streams.h"
#include "pointsweep/storage/remote/url.h"

namespace pointsweep {

FileState::FileState(const std::filesystem::path& path) : path_(path) {
  if (is_standard_stream(path)) return;
  if (is_url(path_)) {
    object_ = RemoteObject::open(path_);
    known_ = true;
    return;
  }
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return;
  known_ = true;
  device_ = static_cast<std::uint64_t>(status.st_dev);
  inode_ = static_cast<std::uint64_t>(status.st_ino);
  size_ = static_cast<std::uint64_t>(status.st_size);
  seconds_ = status.st_mtim.tv_sec;
  nanoseconds_ = status.st_mtim.tv_nsec;
}

std::string FileState::text() const {
  if (object_) return object_->version().text();
  return fmt::format("{} bytes, written at {}.{:09}", size_, seconds_, nanoseconds_);
}

bool FileState::has_changed() const {
  if (object_) {
    const std::optional<RemoteVersion> now = look_at(path_);
    return !now || !now->is(object_->version());
  }
  const FileState now(path_);
  if (!known_ || !now.known_ || now.device_ != device_ || now.inode_ != inode_) return false;
  return now.size_ != size_ || now.seconds_ != seconds_ || now.nanoseconds_ != nanoseconds_;
}

}  // namespace pointsweep
