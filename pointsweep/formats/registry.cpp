// SPDX-License-Identifier: MIT
#include "pointsweep/formats/registry.h"

#include <algorithm>
#include <array>

#include "pointsweep/fail.h"
#include "pointsweep/formats/e57/e57_format.h"
#include "pointsweep/formats/extension.h"
#include "pointsweep/formats/files/input_file.h"
#include "pointsweep/formats/files/standard_streams.h"
#include "pointsweep/formats/foreign_formats.h"
#include "pointsweep/formats/kitti/kitti_format.h"
#include "pointsweep/formats/las/las_format.h"
#include "pointsweep/formats/mesh/mesh_formats.h"
#include "pointsweep/formats/npy/npy_format.h"
#include "pointsweep/formats/pcd/pcd_format.h"
#include "pointsweep/formats/ply/ply_format.h"
#include "pointsweep/formats/ptx/ptx_format.h"
#include "pointsweep/formats/qsplat/qsplat_format.h"
#include "pointsweep/formats/text/text_format.h"
#include "pointsweep/formats/vtk/vtk_format.h"
#include "pointsweep/points/lower_case.h"

namespace pointsweep {
namespace {

constexpr std::array kFormats{&kPlyFormat, &kLasFormat,       &kLazFormat, &kPcdFormat,    &kE57Format,     &kPtxFormat,
                              &kVtkFormat, &kOffFormat,       &kObjFormat, &kQsplatFormat, &kTextFormat,    &kPtsFormat,
                              &kCsvFormat, &kNpyPointsFormat, &kNpyFormat, &kKittiFormat,  &kFloatXyzFormat};

bool is_written_as_points(const Format& format) {
  return format.content == Format::Content::points && format.create != nullptr;
}
bool is_read_as_points(const Format& format) {
  return format.content == Format::Content::points && format.open != nullptr;
}
bool has_extension(const Format& format, std::string_view extension) {
  return std::ranges::find(format.extensions, extension) != format.extensions.end();
}

/// Null for "".
const Format* format_asked_for(std::string_view name) {
  for (const Format* format : kFormats)
    if (!name.empty() && format->asked_for_as == name) return format;
  return nullptr;
}

/// Returns whether a file has the extension of a format other than `asked`, which has no signature.
bool names_another(const std::filesystem::path& path, const Format& asked) {
  const std::string extension = extension_of(path);
  return std::ranges::any_of(kFormats, [&](const Format* format) {
    return format != &asked && format->asked_for_as.empty() && has_extension(*format, extension);
  });
}

/// The first bytes of a file, enough to tell what it is.
std::string head_of(const InputFile& file) {
  std::string head(4096, '\0');
  head.resize(file.read_some(0, std::as_writable_bytes(std::span(head))));
  return head;
}

std::string head_of(const std::filesystem::path& path) {
  const InputFile file(path);
  if (file.size() == 0) fail("{}: is empty (0 bytes); it was perhaps not written or copied completely.", path.string());
  return head_of(file);
}

/// "A, B`last`C": the names of the formats for which `chosen` holds, each once.
template <class Chosen>
std::string names_of(Chosen chosen, std::string_view last) {
  std::vector<std::string_view> names;
  for (const Format* format : kFormats)
    if (chosen(*format) && std::ranges::find(names, format->name) == names.end()) names.push_back(format->name);
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i != 0) text += i + 1 == names.size() ? last : ", ";
    text += names[i];
  }
  return text;
}

std::string names_asked_for(std::string_view separator) {
  std::string names;
  for (const Format* format : kFormats)
    if (!format->asked_for_as.empty())
      names += fmt::format("{}{}", names.empty() ? "" : separator, format->asked_for_as);
  return names;
}

/// The binary formats that are read, for refuse_foreign_format().
std::string formats_with_signature() {
  return names_of([](const Format& f) { return is_read_as_points(f) && f.is; }, " nor ");
}

bool is_foreign(const std::filesystem::path& path, std::string_view head) {
  try {
    refuse_foreign_format(path, head, "", "");
    return false;
  } catch (const Error&) {
    return true;
  }
}

void warn_of_lost_crs(const Format& format, const OutputPlan& plan, Writer& writer) {
  if (!plan.crs || format.holds_crs) return;
  const auto keeps = [](const Format& other) {
    return is_written_as_points(other) && other.is_built_in() && other.holds_crs;
  };
  writer.add_warning(fmt::format("{}: {} cannot hold the coordinate reference system, {}; {} keep it.",
                                 plan.path.string(), format.name, short_text(*plan.crs), names_of(keeps, " and ")));
}

}  // namespace

std::span<const Format* const> formats() { return kFormats; }

const Format* format_of_output(const std::filesystem::path& path) {
  if (is_standard_stream(path)) return &kPlyFormat;
  const std::string extension = extension_of(path);
  for (const Format* format : kFormats)
    if (format->create != nullptr && has_extension(*format, extension)) return format;
  return nullptr;
}

void require_output_name(const std::filesystem::path& output) {
  const Format* const format = format_of_output(output);
  const std::string name = output.string();
  if (format == nullptr || format->refused_ending.empty() || !in_lower_case(name).ends_with(format->refused_ending))
    return;
  const std::string plain = name.substr(0, name.size() - format->refused_ending.size()) + output.extension().string();
  fail_usage("{}: programs expect {} under such a name, which is not written yet; name the output {}, which gets {}.",
             name, format->refused_format, plain, format->name);
}

const Format& array_format() { return kNpyFormat; }

bool is_array_name(const std::filesystem::path& path) {
  const Format* const format = format_of_output(path);
  return format != nullptr && format->content == Format::Content::array;
}

std::string readable_formats() {
  return names_of([](const Format& format) { return is_read_as_points(format) && format.is_built_in(); }, ", ");
}

std::string codecs() {
  std::string there, missing;
  for (const Format* format : kFormats) {
    if (format->codec.empty()) continue;
    std::string& names = format->is_built_in() ? there : missing;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", format->is_built_in() ? format->codec : format->name);
  }
  if (missing.empty()) return there.empty() ? "none" : there;
  return fmt::format("{} (no {})", there.empty() ? "none" : there, missing);
}

std::string formats_asked_for() { return names_asked_for("|"); }

void require_format_asked_for(std::string_view name) {
  if (!name.empty() && format_asked_for(name) == nullptr)
    fail_usage("--format: '{}' is not one of {}; other formats are recognised by the content of a file.", name,
               formats_asked_for());
}

std::unique_ptr<Reader> open_reader(const std::filesystem::path& path, std::string_view format_name) {
  require_format_asked_for(format_name);
  const std::string head = head_of(path);
  if (const Format* const asked = format_asked_for(format_name); asked != nullptr && !names_another(path, *asked))
    return asked->open(path);
  for (const Format* format : kFormats)
    if (is_read_as_points(*format) && format->is != nullptr && format->is(head)) return format->open(path);
  refuse_foreign_format(path, head, formats_with_signature(), names_asked_for(" or "));
  for (const Format* format : kFormats)
    if (is_read_as_points(*format) && format->is == nullptr && format->asked_for_as.empty()) return format->open(path);
  fail("{}: is of no format that pointsweep reads.", path.string());
}

bool is_point_file(const std::filesystem::path& path, std::string_view format_name) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;  // reading a pipe would wait
  const InputFile file(path);
  const std::string extension = extension_of(path);
  if (format_asked_for(format_name) != nullptr && extension == ".bin") return true;
  for (const Format* format : kFormats)
    if (is_read_as_points(*format) && format->asked_for_as.empty() && has_extension(*format, extension) &&
        (format->is != nullptr || file.size() == 0))
      return true;
  const std::string head = head_of(file);
  for (const Format* format : kFormats)
    if (is_read_as_points(*format) && format->is != nullptr && format->is(head)) return true;
  if (is_foreign(path, head)) return false;
  return std::ranges::any_of(kFormats,
                             [&](const Format* f) { return is_read_as_points(*f) && f->fits && f->fits(path); });
}

std::unique_ptr<Writer> create_writer(const OutputPlan& plan) {
  require_output_name(plan.path);
  const Format* const format = format_of_output(plan.path);
  if (format != nullptr && is_written_as_points(*format)) {
    std::unique_ptr<Writer> writer = format->create(plan);
    warn_of_lost_crs(*format, plan, *writer);
    return writer;
  }
  const std::string extension = extension_of(plan.path);
  std::string known;
  for (const std::string_view other : writable_extensions())
    known += fmt::format("{}{}", known.empty() ? "" : ", ", other);
  fail_usage("{}: cannot write {}; use {}{}.", plan.path.string(),
             extension.empty() ? "a file without an extension" : extension, known,
             extension.empty() ? ", or end the name of a folder of outputs with '/'" : "");
}

std::vector<std::string_view> writable_extensions() {
  std::vector<std::string_view> extensions;
  for (const Format* format : kFormats)
    if (is_written_as_points(*format))
      extensions.insert(extensions.end(), format->extensions.begin(), format->extensions.end());
  return extensions;
}

}  // namespace pointsweep
