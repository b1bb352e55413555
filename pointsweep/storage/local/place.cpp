// SPDX-License-Identifier: MIT
#include "pointsweep/storage/local/place.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <system_error>

#include "pointsweep/program/standard_streams.h"
#include "pointsweep/storage/local/unfinished_output.h"
#include "pointsweep/storage/remote/remote_service.h"
#include "pointsweep/storage/remote/url.h"

namespace pointsweep {

namespace fs = std::filesystem;

bool is_folder(const fs::path& path) {
  std::error_code error;
  return is_url(path) ? !path.has_filename() : fs::is_directory(path, error);
}

bool exists_at(const fs::path& path) {
  std::error_code error;
  return is_url(path) ? look_at(path.native()).has_value() : fs::exists(path, error);
}

std::optional<std::uint64_t> bytes_of_file(const fs::path& path) {
  if (is_url(path)) {
    const std::optional<RemoteVersion> found = look_at(path.native());
    return found ? std::optional(found->size) : std::nullopt;
  }
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  const std::uintmax_t bytes = fs::file_size(path, error);
  return error ? std::nullopt : std::optional<std::uint64_t>(bytes);
}

std::string whole_name(const fs::path& path) {
  if (path.empty() || is_url(path)) return path.string();
  return fs::absolute(path).lexically_normal().string();
}

fs::path file_name(const fs::path& path) { return without_query(path).filename(); }

bool share_folder(const fs::path& a, const fs::path& b) {
  if (is_url(a) || is_url(b)) return without_query(a).parent_path() == without_query(b).parent_path();
  std::error_code error;
  return fs::equivalent(folder_of(a), folder_of(b), error);
}

FileState::FileState(const fs::path& path) : path_(path) {
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
