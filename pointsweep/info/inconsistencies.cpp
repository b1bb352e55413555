// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "pointsweep/formats/crs.h"
#include "pointsweep/formats/las_scale.h"
#include "pointsweep/info.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {
namespace {

using SomeFiles = std::vector<const FileSummary*>;

/// Values in the order in which they come first, each with the files that have it.
using FilesOfValues = std::vector<std::pair<std::string, SomeFiles>>;

void add_file(FilesOfValues& all, const std::string& value, const FileSummary& file) {
  auto at = std::ranges::find(all, value, &FilesOfValues::value_type::first);
  if (at == all.end()) at = all.insert(at, {value, {}});
  at->second.push_back(&file);
}

/// "a.las" or "a.las and 3 more".
std::string names_of(const SomeFiles& files) {
  const std::string first = files.front()->info.path.string();
  return files.size() == 1 ? first : fmt::format("{} and {} more", first, files.size() - 1);
}

/// "a", "a and b", "a, b and c".
std::string list_of(const std::vector<std::string>& names) {
  if (names.size() == 1) return names.front();
  const std::vector<std::string> others(names.begin(), names.end() - 1);
  return fmt::format("{} and {}", fmt::join(others, ", "), names.back());
}

/// "float32 in a.ply and 3 more; uint16 in b.las".
std::string text_of(const FilesOfValues& all) {
  std::string text;
  for (const auto& [value, files] : all)
    text += fmt::format("{}{} in {}", text.empty() ? "" : "; ", value, names_of(files));
  return text;
}

/// "Formats differ: ..." where there is more than one value.
void note_different(std::vector<std::string>& sentences, const char* what, const FilesOfValues& all) {
  if (all.size() > 1) sentences.push_back(fmt::format("{} differ: {}.", what, text_of(all)));
}

FilesOfValues formats_of(const SomeFiles& files) {
  FilesOfValues formats;
  for (const FileSummary* file : files) add_file(formats, file->info.format, *file);
  return formats;
}

/// Systems that could be the same are one, that of the first file.
FilesOfValues systems_of(const SomeFiles& files) {
  std::vector<const Crs*> systems;
  FilesOfValues all;
  for (const FileSummary* file : files) {
    if (!file->info.crs) continue;
    const Crs& crs = *file->info.crs;
    const auto same = std::ranges::find_if(
        systems, [&](const Crs* other) { return compare(*other, crs) != CrsAgreement::different; });
    const auto place = static_cast<std::size_t>(same - systems.begin());
    if (same == systems.end()) {
      systems.push_back(&crs);
      all.push_back({short_text(crs), {}});
    }
    all[place].second.push_back(file);
  }
  return all;
}

void note_systems(std::vector<std::string>& sentences, const SomeFiles& files) {
  note_different(sentences, "Coordinate reference systems", systems_of(files));
  SomeFiles without;
  std::ranges::copy_if(files, std::back_inserter(without), [](const FileSummary* file) { return !file->info.crs; });
  if (!without.empty() && without.size() < files.size())
    sentences.push_back(fmt::format("No coordinate reference system is stated in {}.", names_of(without)));
}

FilesOfValues clocks_of(const SomeFiles& files) {
  FilesOfValues clocks;
  for (const FileSummary* file : files)
    if (const auto& las = file->info.las; las && las->has_time)
      add_file(clocks, las->standard_time ? "adjusted standard GPS time" : "seconds of the GPS week", *file);
  return clocks;
}

/// "uint16", "int32[3]", "int32 (scale 0.01)".
std::string storage_of(const Field& field) {
  std::string text(name_of(field.type));
  if (field.count > 1) text += fmt::format("[{}]", field.count);
  if (field.scale != 1) text += fmt::format(" (scale {:g})", field.scale);
  return text;
}

/// An attribute of some of the files, with all that store it in one way.
struct SharedAttribute {
  std::string name;  ///< as the first file calls it
  FilesOfValues storages;
};

/// Under one entry, whatever the files call them (`nx`, `NormalX`); in the order in which they come first.
std::vector<SharedAttribute> attributes_of(const SomeFiles& files) {
  std::vector<SharedAttribute> all;
  std::map<std::string, std::size_t> places;
  for (const FileSummary* file : files) {
    for (const Field& field : file->info.schema.fields) {
      const auto [place, is_new] = places.try_emplace(library_name_of(field.name), all.size());
      if (is_new) all.push_back({field.name, {}});
      add_file(all[place->second].storages, storage_of(field), *file);
    }
  }
  return all;
}

SomeFiles files_without(const SharedAttribute& attribute, const SomeFiles& files) {
  SomeFiles with, without;
  for (const auto& [storage, some] : attribute.storages) with.insert(with.end(), some.begin(), some.end());
  std::ranges::sort(with);
  for (const FileSummary* file : files)
    if (!std::ranges::binary_search(with, file)) without.push_back(file);
  return without;
}

/// A sentence for each set of files that lacks some attributes.
void note_missing(std::vector<std::string>& sentences, const std::vector<SharedAttribute>& attributes,
                  const SomeFiles& files) {
  std::vector<std::pair<SomeFiles, std::vector<std::string>>> missing;
  for (const SharedAttribute& attribute : attributes) {
    SomeFiles without = files_without(attribute, files);
    if (without.empty()) continue;
    auto at = std::ranges::find(missing, without, [](const auto& entry) { return entry.first; });
    if (at == missing.end()) at = missing.insert(at, {std::move(without), {}});
    at->second.push_back(attribute.name);
  }
  for (const auto& [without, names] : missing)
    sentences.push_back(names.size() == 1
                            ? fmt::format("Attribute {} is missing in {}.", names.front(), names_of(without))
                            : fmt::format("Attributes {} are missing in {}.", list_of(names), names_of(without)));
}

void note_types(std::vector<std::string>& sentences, const std::vector<SharedAttribute>& attributes) {
  std::vector<std::pair<std::string, std::vector<std::string>>> different;
  for (const SharedAttribute& attribute : attributes) {
    if (attribute.storages.size() < 2) continue;
    const std::string text = text_of(attribute.storages);
    auto at = std::ranges::find(different, text, [](const auto& entry) { return entry.first; });
    if (at == different.end()) at = different.insert(at, {text, {}});
    at->second.push_back(attribute.name);
  }
  for (const auto& [text, names] : different)
    sentences.push_back(fmt::format("Types of {} differ: {}.", list_of(names), text));
}

void note_points(std::vector<std::string>& sentences, const SomeFiles& files) {
  SomeFiles empty, nonfinite;
  std::uint64_t points = 0;
  for (const FileSummary* file : files) {
    if (file->info.count == 0) empty.push_back(file);
    if (file->nonfinite > 0) nonfinite.push_back(file);
    points += file->nonfinite;
  }
  if (!empty.empty()) sentences.push_back(fmt::format("No points are in {}.", names_of(empty)));
  if (points > 0)
    sentences.push_back(fmt::format("{} {} not finite, in {}.", points,
                                    points == 1 ? "point has coordinates that are" : "points have coordinates that are",
                                    names_of(nonfinite)));
}

void note_copies(std::vector<std::string>& sentences, const SomeFiles& files) {
  std::map<std::array<double, 7>, SomeFiles> same;
  for (const FileSummary* file : files) {
    const Box& b = file->bounds;
    if (file->info.count > 1 && !b.empty())
      same[{static_cast<double>(file->info.count), b.lo.x, b.lo.y, b.lo.z, b.hi.x, b.hi.y, b.hi.z}].push_back(file);
  }
  for (const auto& [key, some] : same)
    if (some.size() > 1)
      sentences.push_back(
          fmt::format("{} have the same bounds and number of points: copies of one file?", names_of(some)));
}

}  // namespace

std::vector<std::string> inconsistencies_of(std::span<const FileSummary> files) {
  SomeFiles all;
  for (const FileSummary& file : files) all.push_back(&file);
  std::vector<std::string> sentences;
  if (files.size() < 2) return sentences;
  const std::vector<SharedAttribute> attributes = attributes_of(all);
  note_different(sentences, "Formats", formats_of(all));
  note_systems(sentences, all);
  note_different(sentences, "Clocks of GPS times", clocks_of(all));
  note_missing(sentences, attributes, all);
  note_types(sentences, attributes);
  note_points(sentences, all);
  note_copies(sentences, all);
  return sentences;
}

}  // namespace pointsweep
