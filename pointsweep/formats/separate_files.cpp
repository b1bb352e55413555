// SPDX-License-Identifier: MIT
#include <sys/stat.h>

#include <map>
#include <string>
#include <system_error>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/files.h"
#include "pointsweep/program/standard_streams.h"
#include "pointsweep/url.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

/// Returns the path without links, `.` and `..`, as far as the path exists.
fs::path canonical_form(const fs::path& path) {
  if (is_url(path)) return path;
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? path.lexically_normal() : canonical;
}

/// Returns a text for messages: "b.las", or "./b.las (b.las)" if the paths are spelled differently.
std::string both_names(const fs::path& named, const fs::path& other) {
  return named == other ? named.string() : fmt::format("{} ({})", named.string(), other.string());
}

/// A set of files, found by inode or canonical path. Each file keeps the path by which it was first named.
class KnownFiles {
 public:
  /// Returns the known path that leads to the same file as `path`; null if the set does not hold the file.
  const fs::path* find(const fs::path& path) const {
    struct stat status {};
    if (::stat(path.c_str(), &status) == 0)
      if (const auto known = by_inode_.find({status.st_dev, status.st_ino}); known != by_inode_.end())
        return &known->second;
    const auto known = by_path_.find(canonical_form(path));
    return known == by_path_.end() ? nullptr : &known->second;
  }
  void add(const fs::path& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) == 0) by_inode_.try_emplace({status.st_dev, status.st_ino}, path);
    by_path_.try_emplace(canonical_form(path), path);
  }

 private:
  std::map<std::pair<dev_t, ino_t>, fs::path> by_inode_;
  std::map<fs::path, fs::path> by_path_;
};

}  // namespace

void require_separate_files(const std::vector<fs::path>& read, const std::vector<fs::path>& written) {
  KnownFiles inputs, outputs;
  for (const fs::path& input : read)
    if (!input.empty() && !is_standard_stream(input)) inputs.add(input);
  bool to_stream = false;
  for (const fs::path& output : written) {
    if (output.empty()) continue;
    if (is_standard_output(output)) {
      if (std::exchange(to_stream, true)) fail_usage("-: is named for two outputs; give each its own file.");
      continue;
    }
    if (const fs::path* input = inputs.find(output))
      fail_usage("{}: is an input, and an input is never overwritten; write to another file.",
                 both_names(output, *input));
    if (const fs::path* other = outputs.find(output))
      fail_usage("{}: is named for two outputs; give each its own file.", both_names(output, *other));
    outputs.add(output);
  }
}

}  // namespace pointsweep
