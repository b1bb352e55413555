// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "pointsweep/formats/crs.h"
#include "pointsweep/formats/las_scale.h"
#include "pointsweep/info.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {
namespace {

/// Files that agree in what kind_of() compares: format, clock, attributes and coordinate reference system.
struct AlikeFiles {
  FileInfo first;         ///< header of the first file, without extras
  std::size_t files = 0;  ///< number of files, including the first
};

/// Some groups of files with equal kind_of(), in the order of their first files.
using SomeKinds = std::vector<const AlikeFiles*>;

/// Distinct values in the order of their first occurrence, each with the files that have it.
using FilesOfValues = std::vector<std::pair<std::string, SomeKinds>>;

/// Adds `member` to the group of `key`, which becomes the last group if it is new.
template <class Key, class Member>
void add_to(std::vector<std::pair<Key, std::vector<Member>>>& groups, const Key& key, Member member) {
  auto at = std::ranges::find(groups, key, [](const auto& group) -> const Key& { return group.first; });
  if (at == groups.end()) at = groups.insert(at, {key, {}});
  at->second.push_back(std::move(member));
}

/// Returns "a.las" or "a.las and 3 more".
std::string names_of(const std::string& first, std::size_t files) {
  return files == 1 ? first : fmt::format("{} and {} more", first, files - 1);
}

std::string names_of(const SomeKinds& kinds) {
  const std::size_t files = std::transform_reduce(kinds.begin(), kinds.end(), std::size_t{0}, std::plus<>{},
                                                  [](const AlikeFiles* kind) { return kind->files; });
  return names_of(kinds.front()->first.path.string(), files);
}

/// Returns "a", "a and b" or "a, b and c".
std::string list_of(const std::vector<std::string>& names) {
  if (names.size() == 1) return names.front();
  const std::vector<std::string> others(names.begin(), names.end() - 1);
  return fmt::format("{} and {}", fmt::join(others, ", "), names.back());
}

/// Returns "float32 in a.ply and 3 more; uint16 in b.las".
std::string text_of(const FilesOfValues& all) {
  std::string text;
  for (const auto& [value, files] : all)
    text += fmt::format("{}{} in {}", text.empty() ? "" : "; ", value, names_of(files));
  return text;
}

/// Adds a sentence such as "Formats differ: ..." if there is more than one value.
void note_different(std::vector<std::string>& sentences, const char* what, const FilesOfValues& all) {
  if (all.size() > 1) sentences.push_back(fmt::format("{} differ: {}.", what, text_of(all)));
}

FilesOfValues formats_of(const SomeKinds& files) {
  FilesOfValues formats;
  for (const AlikeFiles* kind : files) add_to(formats, kind->first.format, kind);
  return formats;
}

/// Returns the distinct coordinate reference systems. Of systems that may be equal, only the first one is listed.
FilesOfValues systems_of(const SomeKinds& files) {
  std::vector<const Crs*> systems;
  FilesOfValues all;
  for (const AlikeFiles* kind : files) {
    if (!kind->first.crs) continue;
    const Crs& crs = *kind->first.crs;
    const auto same = std::ranges::find_if(
        systems, [&](const Crs* other) { return compare(*other, crs) != CrsAgreement::different; });
    const auto place = static_cast<std::size_t>(same - systems.begin());
    if (same == systems.end()) {
      systems.push_back(&crs);
      all.push_back({short_text(crs), {}});
    }
    all[place].second.push_back(kind);
  }
  return all;
}

void note_systems(std::vector<std::string>& sentences, const SomeKinds& files) {
  note_different(sentences, "Coordinate reference systems", systems_of(files));
  SomeKinds without;
  std::ranges::copy_if(files, std::back_inserter(without), [](const AlikeFiles* kind) { return !kind->first.crs; });
  if (!without.empty() && without.size() < files.size())
    sentences.push_back(fmt::format("No coordinate reference system is stated in {}.", names_of(without)));
}

/// Returns the clock of the GPS times; empty for a file without GPS times or of another format than LAS.
std::string clock_of(const FileInfo& info) {
  if (!info.las || !info.las->has_time) return "";
  return info.las->standard_time ? "adjusted standard GPS time" : "seconds of the GPS week";
}

FilesOfValues clocks_of(const SomeKinds& files) {
  FilesOfValues clocks;
  for (const AlikeFiles* kind : files)
    if (const std::string clock = clock_of(kind->first); !clock.empty()) add_to(clocks, clock, kind);
  return clocks;
}

/// Returns a text such as "uint16", "int32[3]" or "int32 (scale 0.01)".
std::string storage_of(const Field& field) {
  std::string text(name_of(field.type));
  if (field.count > 1) text += fmt::format("[{}]", field.count);
  if (field.scale != 1) text += fmt::format(" (scale {:g})", field.scale);
  return text;
}

/// An attribute, and for each way to store its values the files that use this way.
struct SharedAttribute {
  std::string name;  ///< name in the first file
  FilesOfValues storages;
};

/// Returns the attributes of the files in the order of their first occurrence. Names with one meaning (`nx`, `NormalX`)
/// are one attribute.
std::vector<SharedAttribute> attributes_of(const SomeKinds& files) {
  std::vector<SharedAttribute> all;
  std::map<std::string, std::size_t> places;
  for (const AlikeFiles* kind : files) {
    for (const Field& field : kind->first.schema.fields) {
      const auto [place, is_new] = places.try_emplace(library_name_of(field.name), all.size());
      if (is_new) all.push_back({field.name, {}});
      add_to(all[place->second].storages, storage_of(field), kind);
    }
  }
  return all;
}

SomeKinds files_without(const SharedAttribute& attribute, const SomeKinds& files) {
  SomeKinds with, without;
  for (const auto& [storage, some] : attribute.storages) with.insert(with.end(), some.begin(), some.end());
  std::ranges::sort(with);
  for (const AlikeFiles* kind : files)
    if (!std::ranges::binary_search(with, kind)) without.push_back(kind);
  return without;
}

/// Adds a sentence for each set of files that lacks some attributes.
void note_missing(std::vector<std::string>& sentences, const std::vector<SharedAttribute>& attributes,
                  const SomeKinds& files) {
  std::vector<std::pair<SomeKinds, std::vector<std::string>>> missing;
  for (const SharedAttribute& attribute : attributes) {
    const SomeKinds without = files_without(attribute, files);
    if (!without.empty()) add_to(missing, without, attribute.name);
  }
  for (const auto& [without, names] : missing)
    sentences.push_back(names.size() == 1
                            ? fmt::format("Attribute {} is missing in {}.", names.front(), names_of(without))
                            : fmt::format("Attributes {} are missing in {}.", list_of(names), names_of(without)));
}

void note_types(std::vector<std::string>& sentences, const std::vector<SharedAttribute>& attributes) {
  std::vector<std::pair<std::string, std::vector<std::string>>> different;
  for (const SharedAttribute& attribute : attributes)
    if (attribute.storages.size() > 1) add_to(different, text_of(attribute.storages), attribute.name);
  for (const auto& [text, names] : different)
    sentences.push_back(fmt::format("Types of {} differ: {}.", list_of(names), text));
}

/// Returns a text that is equal for files with the same format, clock of the GPS times, coordinate reference system,
/// and names, types and scales of the attributes, in the same order.
std::string kind_of(const FileInfo& info) {
  std::string text = info.format + '\n' + clock_of(info);
  for (const Field& field : info.schema.fields) text += '\n' + field.name + '\n' + storage_of(field);
  if (!info.crs) return text;
  const Crs& crs = *info.crs;
  text +=
      fmt::format("\n{}\n{}\n{}\n{}\n{}", crs.name, static_cast<int>(crs.kind), crs.epsg, crs.vertical_epsg, crs.wkt);
  return text + fmt::format("\n{}\n{}\n{}", fmt::join(crs.geotiff.directory, " "), fmt::join(crs.geotiff.doubles, " "),
                            crs.geotiff.ascii);
}

/// A number of files, and the path of the first.
struct SomeFiles {
  std::string first;  ///< path of the first file
  std::size_t files = 0;

  void add(const std::string& path) {
    if (files++ == 0) first = path;
  }
};

struct Extent {
  std::array<double, 7> key;  ///< number of points, least x, y and z, greatest x, y and z
  std::string path;
};

void note_points(std::vector<std::string>& sentences, const SomeFiles& empty, const SomeFiles& with_nonfinite,
                 std::uint64_t nonfinite) {
  if (empty.files > 0) sentences.push_back(fmt::format("No points are in {}.", names_of(empty.first, empty.files)));
  if (nonfinite > 0)
    sentences.push_back(
        fmt::format("{} {} not finite, in {}.", nonfinite,
                    nonfinite == 1 ? "point has coordinates that are" : "points have coordinates that are",
                    names_of(with_nonfinite.first, with_nonfinite.files)));
}

void note_copies(std::vector<std::string>& sentences, const std::vector<Extent>& extents) {
  std::vector<const Extent*> ordered;
  for (const Extent& extent : extents) ordered.push_back(&extent);
  std::ranges::stable_sort(
      ordered, {}, [](const Extent* extent) -> const auto& { return extent->key; });
  for (std::size_t i = 0, end = 0; i < ordered.size(); i = end) {
    while (end < ordered.size() && ordered[end]->key == ordered[i]->key) ++end;
    if (end - i > 1)
      sentences.push_back(fmt::format("{} have the same bounds and number of points: copies of one file?",
                                      names_of(ordered[i]->path, end - i)));
  }
}

}  // namespace

struct FileComparison::Known {
  std::size_t files = 0;
  std::vector<AlikeFiles> alike;                          ///< in the order of their first files
  std::unordered_map<std::string, std::size_t> place_of;  ///< index in `alike`, by kind_of()
  SomeFiles empty, with_nonfinite;
  std::uint64_t nonfinite = 0;
  std::vector<Extent> extents;  ///< of files with two points or more, at least one of them finite
};

FileComparison::FileComparison() : known_(std::make_unique<Known>()) {}
FileComparison::~FileComparison() = default;
FileComparison::FileComparison(FileComparison&&) noexcept = default;
FileComparison& FileComparison::operator=(FileComparison&&) noexcept = default;

void FileComparison::add(const FileSummary& file) {
  const FileInfo& info = file.info;
  const std::string path = info.path.string();
  const auto [at, is_new] = known_->place_of.try_emplace(kind_of(info), known_->alike.size());
  if (is_new) {
    known_->alike.push_back({info});
    known_->alike.back().first.extras = nullptr;
  }
  ++known_->alike[at->second].files;
  ++known_->files;
  if (info.count == 0) known_->empty.add(path);
  if (file.nonfinite > 0) known_->with_nonfinite.add(path);
  known_->nonfinite += file.nonfinite;
  const Box& b = file.bounds;
  if (info.count > 1 && !b.empty())
    known_->extents.push_back(
        {{static_cast<double>(info.count), b.lo.x, b.lo.y, b.lo.z, b.hi.x, b.hi.y, b.hi.z}, path});
}

std::vector<std::string> FileComparison::sentences() const {
  std::vector<std::string> sentences;
  if (known_->files < 2) return sentences;
  SomeKinds all;
  for (const AlikeFiles& kind : known_->alike) all.push_back(&kind);
  const std::vector<SharedAttribute> attributes = attributes_of(all);
  note_different(sentences, "Formats", formats_of(all));
  note_systems(sentences, all);
  note_different(sentences, "Clocks of GPS times", clocks_of(all));
  note_missing(sentences, attributes, all);
  note_types(sentences, attributes);
  note_points(sentences, known_->empty, known_->with_nonfinite, known_->nonfinite);
  note_copies(sentences, known_->extents);
  return sentences;
}

std::vector<std::string> inconsistencies_of(std::span<const FileSummary> files) {
  FileComparison comparison;
  for (const FileSummary& file : files) comparison.add(file);
  return comparison.sentences();
}

}  // namespace pointsweep
