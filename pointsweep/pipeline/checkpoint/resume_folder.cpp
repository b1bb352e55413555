// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/checkpoint/resume_folder.h"

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>

#include "pointsweep/fail.h"

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
  if (is_saving())  // truncates files that the other thread flushes, so that it need not write them
    for (const std::string& name : others_than({})) fs::resize_file(path() / name, 0, ignored);
  if (saving_.valid()) saving_.wait();
  forget();
  folder_.remove_folder();
}

}  // namespace pointsweep
