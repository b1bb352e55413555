// SPDX-License-Identifier: MIT
#include "pointsweep/formats/cloud/virtual_cloud.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>

#include "pointsweep/fail.h"
#include "pointsweep/formats/extension.h"
#include "pointsweep/formats/files/input_file.h"

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

/// Returns the place of a feature's points; none if the feature does not state it.
std::optional<std::string> href_of(const Json& feature) {
  const Json assets = feature.is_object() ? feature.value("assets", Json()) : Json();
  if (!assets.is_object()) return std::nullopt;
  const Json* data = assets.contains("data") ? &assets["data"] : nullptr;
  for (auto asset = assets.begin(); data == nullptr && asset != assets.end(); ++asset)
    if (asset->is_object() && has_role_of_data(*asset)) data = &*asset;
  if (data == nullptr || !data->is_object() || !data->value("href", Json()).is_string()) return std::nullopt;
  return (*data)["href"].get<std::string>();
}

/// "%20" is a space in addresses, not in paths.
std::string unescaped(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto digit = [&](std::size_t at) {
      return at < text.size() ? std::string_view("0123456789abcdef").find(static_cast<char>(text[at] | 32))
                              : std::string_view::npos;
    };
    const bool is_escape =
        text[i] == '%' && digit(i + 1) != std::string_view::npos && digit(i + 2) != std::string_view::npos;
    out += is_escape ? static_cast<char>(digit(i + 1) * 16 + digit(i + 2)) : text[i];
    if (is_escape) i += 2;
  }
  return out;
}

fs::path path_of(const fs::path& collection, const std::string& href) {
  constexpr std::string_view kFile = "file://";
  if (href.starts_with(kFile)) return unescaped(href.substr(kFile.size()));
  if (href.find("://") != href.npos)
    fail("{}: names {}, which is in the network; download the files and make a .vpc of these.", collection.string(),
         href);
  return (collection.parent_path() / href).lexically_normal();
}

/// Its name below the folder of the collection; its file name if it is not below it.
fs::path relative_name(const fs::path& collection, const fs::path& file) {
  const fs::path folder = collection.parent_path();
  const fs::path relative = file.lexically_relative(folder.empty() ? fs::path(".") : folder);
  return relative.empty() || relative.begin()->string() == ".." ? file.filename() : relative;
}

void require_existing(const fs::path& collection, const std::vector<ListedFile>& files) {
  std::vector<fs::path> missing;
  std::error_code error;
  for (const ListedFile& file : files)
    if (!fs::exists(file.path, error)) missing.push_back(file.path);
  if (missing.empty()) return;
  const std::string more = missing.size() == 1 ? "" : fmt::format(" (and {} more)", missing.size() - 1);
  fail("{}: names {}, which does not exist{}; put the files where it names them, or make it again.",
       collection.string(), missing.front().string(), more);
}

}  // namespace

bool is_virtual_cloud(const fs::path& path) { return extension_of(path) == ".vpc"; }

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

}  // namespace pointsweep
