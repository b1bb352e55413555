// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/checkpoint/resume_folder.h"

#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <system_error>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/storage/local/output_file.h"
#include "pointsweep/storage/remote/remote_service.h"
#include "pointsweep/storage/remote/url.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCheckpoint = "checkpoint";

bool is_data(const std::string& name) {
  return name.starts_with("stream-") || name.starts_with("results-") || name.starts_with("rows-") ||
         name.starts_with("mask-") || name.starts_with("decoded-");
}

}  // namespace

ResumeFolder::ResumeFolder(const fs::path& path) : folder_(path, "a checkpoint", "--resume") { load(); }

ResumeFolder::~ResumeFolder() {
  if (saving_.valid()) saving_.wait();
  try {
    if (!holds_work_) remove();
  } catch (const Error&) {
    // Errors are ignored: the next run with this folder removes the rest or reports why it cannot.
  }
}

void ResumeFolder::load() {
  for (const std::string& name : folder_.list()) {
    if (name == kCheckpoint) holds_work_ = true;
    if (name != kCheckpoint && name != kTiles && !is_data(name))
      fail("'{}' holds '{}', which no run to be resumed has left; name an empty or a new folder with --resume.",
           path().string(), name);
  }
  if (!holds_work_) return forget();
  std::optional<std::vector<std::byte>> bytes = sealed_bytes(folder_, kCheckpoint);
  if (!bytes) fail("'{}' is damaged: remove the folder and start again.", (path() / kCheckpoint).string());
  saved_ = std::move(*bytes);
}

void ResumeFolder::save(std::vector<std::byte> bytes, const std::set<std::string>& names) {
  if (saving_.valid()) saving_.get();
  saving_ = std::async(std::launch::async, [this, bytes = std::move(bytes), names, others = others_than(names)] {
    for (const std::string& name : names) folder_.flush(name);
    {
      const std::lock_guard lock(removal_);
      if (removing_) return;
      seal_bytes(folder_, kCheckpoint, bytes);
      holds_work_ = true;
    }
    for (const std::string& name : others) folder_.remove(name);
  });
}

bool ResumeFolder::is_saving() const {
  return saving_.valid() && saving_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
}

std::vector<std::string> ResumeFolder::others_than(const std::set<std::string>& names) const {
  std::vector<std::string> others = folder_.list();
  std::erase_if(others, [&](const std::string& name) { return !is_data(name) || names.contains(name); });
  return others;
}

void ResumeFolder::keep_only(const std::set<std::string>& names) {
  for (const std::string& name : others_than(names)) folder_.remove(name);
}

void ResumeFolder::forget() {
  folder_.remove(kCheckpoint);
  folder_.remove(kTiles);
  keep_only({});
}

/// Removes the checkpoint first, so that an interrupted removal leaves no checkpoint without its data.
void ResumeFolder::remove() {
  {
    const std::lock_guard lock(removal_);
    removing_ = true;
    folder_.remove(kCheckpoint);
    folder_.flush();
  }
  std::error_code ignored;
  if (is_saving())  // truncates the files that the saving thread flushes, which spares writing their data
    for (const std::string& name : others_than({})) fs::resize_file(path() / name, 0, ignored);
  if (saving_.valid()) saving_.wait();
  forget();
  folder_.remove_folder();
}

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
  if (is_url(output)) return;  // an object in the network becomes visible only when it is complete
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
