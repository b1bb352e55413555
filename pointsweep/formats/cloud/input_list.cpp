// SPDX-License-Identifier: MIT
/// The implementation of files.h: the files that an argument stands for, and arguments that name the same file.
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/files.h"
#include "pointsweep/formats/files/file_pattern.h"
#include "pointsweep/formats/files/folders.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/program/standard_streams.h"
#include "pointsweep/storage/local/input_file.h"
#include "pointsweep/storage/local/place.h"
#include "pointsweep/storage/remote/remote_service.h"
#include "pointsweep/storage/remote/url.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

Json collection_in(const fs::path& path) {
  constexpr std::uint64_t kMostBytes = 1 << 28;
  const InputFile file(path);
  if (file.size() > kMostBytes)
    fail("{}: has {} bytes, and a virtual point cloud is at most {} long; name the files instead.", path.string(),
         file.size(), kMostBytes);
  std::string text(file.size(), '\0');
  file.read_at(0, std::as_writable_bytes(std::span(text)));
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object())
    fail("{}: is no JSON object, so no virtual point cloud; write it again with the program that made it.",
         path.string());
  if (json.value("type", Json()) != "FeatureCollection" || !json.value("features", Json()).is_array())
    fail("{}: is no virtual point cloud: it has no \"type\": \"FeatureCollection\" with \"features\".", path.string());
  return json;
}

bool has_role_of_data(const Json& asset) {
  const Json roles = asset.value("roles", Json::array());
  return roles.is_array() && std::ranges::find(roles, Json("data")) != roles.end();
}

/// Returns the path or URL of a feature's points; none if the feature states neither.
std::optional<std::string> href_of(const Json& feature) {
  const Json assets = feature.is_object() ? feature.value("assets", Json()) : Json();
  if (!assets.is_object()) return std::nullopt;
  const Json* data = assets.contains("data") ? &assets["data"] : nullptr;
  for (auto asset = assets.begin(); data == nullptr && asset != assets.end(); ++asset)
    if (asset->is_object() && has_role_of_data(*asset)) data = &*asset;
  if (data == nullptr || !data->is_object() || !data->value("href", Json()).is_string()) return std::nullopt;
  return (*data)["href"].get<std::string>();
}

fs::path path_of(const fs::path& collection, const std::string& href) {
  if (is_url(href)) return known_place(href);
  if (is_url(collection)) return resolved(collection.string(), href);
  return (collection.parent_path() / href).lexically_normal();
}

/// Returns the path of a file relative to the folder of the collection; the file name if the file is elsewhere.
fs::path relative_name(const fs::path& collection, const fs::path& file) {
  const fs::path folder = collection.parent_path();
  const fs::path relative = file.lexically_relative(folder.empty() ? fs::path(".") : folder);
  return relative.empty() || relative.begin()->string() == ".." ? file_name(file) : relative;
}

void require_existing(const fs::path& collection, const std::vector<ListedFile>& files) {
  std::vector<fs::path> missing;
  std::error_code error;
  for (const ListedFile& file : files)
    if (!is_url(file.path) && !fs::exists(file.path, error)) missing.push_back(file.path);
  if (missing.empty()) return;
  const std::string more = missing.size() == 1 ? "" : fmt::format(" (and {} more)", missing.size() - 1);
  fail("{}: names {}, which does not exist{}; put the files where it names them, or make it again.",
       collection.string(), missing.front().string(), more);
}

/// Returns whether the extension is .vpc.
bool is_virtual_cloud(const fs::path& path) { return extension_of(path) == ".vpc"; }

/// Returns the files of a virtual point cloud: for each feature its asset "data", or else its first asset with the role
/// "data". Relative names begin at the folder of the .vpc file. Throws Error if the .vpc file is not a collection, has
/// no features, or has a feature without such an asset, and for local files that do not exist; objects on servers are
/// checked when they are opened.
std::vector<ListedFile> files_of_virtual_cloud(const fs::path& path) {
  const Json collection = collection_in(path);
  std::vector<ListedFile> files;
  for (const Json& feature : collection["features"]) {
    const std::optional<std::string> href = href_of(feature);
    if (!href)
      fail("{}: feature {} has no asset \"data\" with an \"href\", so its points are unknown; make the file again.",
           path.string(), files.size());
    const fs::path file = path_of(path, *href);
    files.push_back({file, relative_name(path, file)});
  }
  if (files.empty()) fail("{}: names no point file; make it again.", path.string());
  require_existing(path, files);
  return files;
}

enum class ArgumentKind { file, folder, pattern, virtual_cloud };

ArgumentKind kind_of(const fs::path& path) {
  if (is_standard_stream(path)) return ArgumentKind::file;
  if (is_folder(path)) return ArgumentKind::folder;
  if (is_url(path) ? is_remote_pattern(path) : is_file_pattern(path)) return ArgumentKind::pattern;
  return is_virtual_cloud(path) ? ArgumentKind::virtual_cloud : ArgumentKind::file;
}

/// Returns the rest of `path` after `folder`, with which `path` begins.
fs::path below(const fs::path& folder, const fs::path& path) {
  return folder.empty() ? path : path.lexically_relative(folder);
}

void add_files_of(const fs::path& folder, bool recursive, std::vector<fs::path>& files) {
  if (is_url(folder)) {
    for (const RemoteEntry& entry : list_remote(folder.string(), recursive))
      if (!is_hidden(entry.url)) files.emplace_back(entry.url);
    return;
  }
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

/// Device and inode of a file, or a URL.
using Identity = std::tuple<dev_t, ino_t, std::string>;

/// Returns the identity of a file; nothing if there is no such file.
std::optional<Identity> identity_of(const fs::path& file) {
  if (is_url(file)) return Identity{0, 0, file.string()};
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return std::nullopt;
  return Identity{status.st_dev, status.st_ino, ""};
}

class Lister {
 public:
  Lister(bool recursive, const std::string& format) : recursive_(recursive), format_(format) {}

  InputList run(const std::vector<fs::path>& named) {
    for (const fs::path& name : named) {
      const fs::path path = known_place(name);
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
        return out_.files.push_back({path, file_name(path)});
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
    for (const fs::path& match : is_url(pattern) ? remote_matches_of(pattern) : matches_of(pattern)) {
      is_folder(match) ? add_files_of(match, recursive_, files) : files.push_back(match);
    }
    if (files.empty())
      fail("{}: no file has a name of this pattern; check the folder and the pattern.", pattern.string());
    if (!add_point_files(pattern, is_url(pattern) ? fixed_remote_part(pattern) : fixed_part(pattern), files))
      fail("{}: no file of this pattern is a point file, the first is {}; name others.", pattern.string(),
           std::ranges::min(files).string());
  }

  /// Adds the point files among `files`, and a notice about the other files. Returns false if there are no point files.
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

  /// Throws UsageError for a file that is listed twice, since its points would be read twice. A file may be listed
  /// twice if both arguments are paths of the file itself.
  void require_each_once(const fs::path& argument) {
    const bool by_own_name = kind_of(argument) == ArgumentKind::file;
    for (; checked_ < out_.files.size(); ++checked_) {
      const fs::path& file = out_.files[checked_].path;
      const std::optional<Identity> identity = identity_of(file);
      if (!identity) continue;
      const auto [other, is_new] = seen_.try_emplace(*identity, Seen{file, by_own_name});
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
  std::string format_;  ///< value of --format
  InputList out_;
  std::size_t checked_ = 0;  ///< number of listed files that are checked
  std::map<Identity, Seen> seen_;
};

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

/// A set of files, found by identity or canonical path. Each file keeps the path by which it was added first.
class KnownFiles {
 public:
  /// Returns the known path that leads to the same file as `path`; null if the set does not hold the file.
  const fs::path* find(const fs::path& path) const {
    if (const std::optional<Identity> identity = identity_of(path))
      if (const auto known = by_identity_.find(*identity); known != by_identity_.end()) return &known->second;
    const auto known = by_path_.find(canonical_form(path));
    return known == by_path_.end() ? nullptr : &known->second;
  }
  void add(const fs::path& path) {
    if (const std::optional<Identity> identity = identity_of(path)) by_identity_.try_emplace(*identity, path);
    by_path_.try_emplace(canonical_form(path), path);
  }

 private:
  std::map<Identity, fs::path> by_identity_;
  std::map<fs::path, fs::path> by_path_;
};

}  // namespace

InputList list_inputs(const std::vector<fs::path>& named, bool recursive, const std::string& format) {
  return Lister(recursive, format).run(named);
}

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

bool stands_for_files(const fs::path& path) { return kind_of(known_place(path)) != ArgumentKind::file; }

fs::path tile_name(const fs::path& relative, const std::string& format) {
  if (format.empty()) return relative;
  const std::string name = relative.filename().string();
  return relative.parent_path() / (name.substr(0, name.size() - extension_of(relative).size()) + format);
}

}  // namespace pointsweep
