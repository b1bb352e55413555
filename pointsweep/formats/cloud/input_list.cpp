// SPDX-License-Identifier: MIT
#include <sys/stat.h>

#include <algorithm>
#include <map>
#include <system_error>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/files.h"
#include "pointsweep/formats/cloud/virtual_cloud.h"
#include "pointsweep/formats/extension.h"
#include "pointsweep/formats/files/file_pattern.h"
#include "pointsweep/formats/files/folder_entries.h"
#include "pointsweep/formats/files/standard_streams.h"
#include "pointsweep/formats/registry.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

enum class ArgumentKind { file, folder, pattern, virtual_cloud };

ArgumentKind kind_of(const fs::path& path) {
  std::error_code error;
  if (is_standard_stream(path)) return ArgumentKind::file;
  if (fs::is_directory(path, error)) return ArgumentKind::folder;
  if (is_file_pattern(path)) return ArgumentKind::pattern;
  return is_virtual_cloud(path) ? ArgumentKind::virtual_cloud : ArgumentKind::file;
}

/// `path` below `folder`, which begins it.
fs::path below(const fs::path& folder, const fs::path& path) {
  return folder.empty() ? path : path.lexically_relative(folder);
}

void add_files_of(const fs::path& folder, bool recursive, std::vector<fs::path>& files) {
  for (const fs::directory_entry& entry : entries_of(folder)) {
    std::error_code error;
    if (is_hidden(entry.path())) continue;
    if (fs::is_directory(entry.path(), error)) {
      if (recursive && is_own_folder(entry)) add_files_of(entry.path(), true, files);
    } else {
      files.push_back(entry.path());
    }
  }
}

class Lister {
 public:
  Lister(bool recursive, const std::string& format) : recursive_(recursive), format_(format) {}

  InputList run(const std::vector<fs::path>& named) {
    for (const fs::path& path : named) {
      list(path);
      require_each_once(path);
    }
    return std::move(out_);
  }

 private:
  void list(const fs::path& path) {
    switch (kind_of(path)) {
      case ArgumentKind::file:
        if (path.empty()) fail_usage("an input has an empty name; name a point file, a folder or a pattern.");
        return out_.files.push_back({path, path.filename()});
      case ArgumentKind::virtual_cloud:
        for (ListedFile& file : files_of_virtual_cloud(path)) out_.files.push_back(std::move(file));
        return;
      case ArgumentKind::folder:
        return list_folder(path);
      case ArgumentKind::pattern:
        return list_pattern(path);
    }
  }

  void list_folder(const fs::path& folder) {
    std::vector<fs::path> files;
    add_files_of(folder, recursive_, files);
    const bool any = add_point_files(folder, folder, files);
    if (!any && recursive_) fail("{}: holds no point file, nor do its folders; name another folder.", folder.string());
    if (!any)
      fail("{}: holds no point file; name another folder, or add --recursive for the files in its folders.",
           folder.string());
  }

  void list_pattern(const fs::path& pattern) {
    std::vector<fs::path> files;
    for (const fs::path& match : matches_of(pattern)) {
      std::error_code error;
      fs::is_directory(match, error) ? add_files_of(match, recursive_, files) : files.push_back(match);
    }
    if (files.empty())
      fail("{}: no file has a name of this pattern; check the folder and the pattern.", pattern.string());
    if (!add_point_files(pattern, fixed_part(pattern), files))
      fail("{}: no file of this pattern is a point file, the first is {}; name others.", pattern.string(),
           std::ranges::min(files).string());
  }

  /// Adds those of `files` that are point files, and says which are none. False if none is.
  bool add_point_files(const fs::path& named, const fs::path& folder, const std::vector<fs::path>& files) {
    std::vector<std::pair<std::string, fs::path>> ordered;
    for (const fs::path& file : files) ordered.emplace_back(below(folder, file).generic_string(), file);
    std::ranges::sort(ordered);
    std::vector<fs::path> others;
    const std::size_t before = out_.files.size();
    for (const auto& [relative, file] : ordered) {
      stop_if_cancelled();
      is_point_file(file, format_) ? out_.files.push_back({file, relative}) : others.push_back(file);
    }
    if (out_.files.size() == before) return false;
    if (others.size() == 1)
      out_.notices.push_back(
          fmt::format("{}: {} is no point file and is left out.", named.string(), others[0].string()));
    if (others.size() > 1)
      out_.notices.push_back(fmt::format("{}: {} files are no point files and are left out, the first {}.",
                                         named.string(), others.size(), others[0].string()));
    return true;
  }

  /// Points of a file that a folder and another argument name would come twice.
  void require_each_once(const fs::path& argument) {
    const bool by_own_name = kind_of(argument) == ArgumentKind::file;
    for (; checked_ < out_.files.size(); ++checked_) {
      const fs::path& file = out_.files[checked_].path;
      struct stat status {};
      if (::stat(file.c_str(), &status) != 0) continue;
      const auto [other, is_new] = seen_.try_emplace({status.st_dev, status.st_ino}, Seen{file, by_own_name});
      if (is_new || (by_own_name && other->second.by_own_name)) continue;
      if (other->second.path == file)
        fail_usage("{}: is listed twice, the second time by {}; name it once.", file.string(), argument.string());
      fail_usage("{} and {} are the same file, the second listed by {}; name it once.", other->second.path.string(),
                 file.string(), argument.string());
    }
  }

  struct Seen {
    fs::path path;
    bool by_own_name;
  };
  bool recursive_;
  std::string format_;  ///< of --format
  InputList out_;
  std::size_t checked_ = 0;  ///< files of the list
  std::map<std::pair<dev_t, ino_t>, Seen> seen_;
};

}  // namespace

InputList list_inputs(const std::vector<fs::path>& named, bool recursive, const std::string& format) {
  return Lister(recursive, format).run(named);
}

bool stands_for_files(const fs::path& path) { return kind_of(path) != ArgumentKind::file; }

std::filesystem::path tile_name(const std::filesystem::path& relative, const std::string& format) {
  std::filesystem::path name = relative;
  if (extension_of(name) == ".laz" && extension_of(name.stem()) == ".copc")
    name = name.parent_path() / std::filesystem::path(name.stem()).stem().concat(name.extension().string());
  return format.empty() ? name : name.replace_extension(format);
}

}  // namespace pointsweep
