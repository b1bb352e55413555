// SPDX-License-Identifier: MIT
#include "pointsweep/storage/local/place.h"

#include <system_error>

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

}  // namespace pointsweep
