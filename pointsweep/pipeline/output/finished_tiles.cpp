// SPDX-License-Identifier: MIT
#include <sys/stat.h>

#include <fstream>

#include "pointsweep/fail.h"
#include "pointsweep/pipeline/checkpoint/resume_folder.h"
#include "pointsweep/pipeline/output/tile_set.h"
#include "pointsweep/storage/local/output_file.h"
#include "pointsweep/storage/remote/remote_service.h"
#include "pointsweep/storage/remote/url.h"

namespace pointsweep {

FinishedTiles::FinishedTiles(const std::filesystem::path& resume_folder)
    : list_(resume_folder.empty() ? std::filesystem::path() : resume_folder / ResumeFolder::kTiles) {
  if (list_.empty()) return;
  std::ifstream lines(list_);
  std::size_t tile = 0;
  File file;
  while (lines >> tile >> file.device >> file.inode >> file.bytes >> file.changed) files_[tile] = file;
}

bool FinishedTiles::find(const std::filesystem::path& path, File& file) {
  if (is_url(path)) {
    const std::optional<RemoteVersion> object = look_at(path.native());
    if (!object) return false;
    file = {0, std::hash<std::string>{}(object->etag), object->size, object->seconds};
    return true;
  }
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return false;
  file = {status.st_dev, status.st_ino, static_cast<std::uint64_t>(status.st_size),
          status.st_mtim.tv_sec * std::int64_t{1'000'000'000} + status.st_mtim.tv_nsec};
  return true;
}

bool FinishedTiles::has(std::size_t tile, const std::filesystem::path& output) const {
  const auto listed = files_.find(tile);
  File file;
  if (listed == files_.end() || !find(output, file)) return false;
  const File& wanted = listed->second;
  if (file.device != wanted.device || file.inode != wanted.inode) return false;
  return wanted.changed == 0 || (file.bytes == wanted.bytes && file.changed == wanted.changed);
}

void FinishedTiles::begin(std::size_t tile, const std::filesystem::path& output) {
  if (is_url(output)) return;  // an object becomes visible only when it is complete
  File file;
  if (list_.empty() || !find(OutputFile::unfinished_path(output), file)) return;
  add(tile, {file.device, file.inode, 0, 0});
}

void FinishedTiles::end(std::size_t tile, const std::filesystem::path& output) {
  File file;
  if (!list_.empty() && find(output, file)) add(tile, file);
}

void FinishedTiles::add(std::size_t tile, const File& file) {
  std::ofstream lines(list_, std::ios::app);
  lines << fmt::format("{} {} {} {} {}\n", tile, file.device, file.inode, file.bytes, file.changed) << std::flush;
  if (!lines) fail("{}: cannot be written; free space there, and run the command again.", list_.string());
}

}  // namespace pointsweep
