// SPDX-License-Identifier: MIT
#include "pointsweep/formats/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "pointsweep/fail.h"
#include "pointsweep/formats/chosen_chunks.h"
#include "pointsweep/formats/files/folders.h"
#include "pointsweep/points/lower_case.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/program/standard_streams.h"
#include "pointsweep/storage/local/input_file.h"
#include "pointsweep/storage/local/place.h"
#include "pointsweep/storage/remote/url.h"

namespace pointsweep {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view kWithMeshTool = "export its points as PLY, e.g. with MeshLab or CloudCompare";
constexpr std::string_view kUnpack = "unpack it first";

struct Magic {
  std::string_view bytes;
  std::string_view what;
  std::string_view remedy;
};
/// Foreign files that are recognised by their first bytes.
constexpr Magic kMagics[] = {
    {"\x1f\x8b"sv, "a gzip archive", kUnpack},
    {"PK\x03\x04"sv, "a zip archive", kUnpack},
    {"BZh"sv, "a bzip2 archive", kUnpack},
    {"\xfd\x37zXZ\0"sv, "an xz archive", kUnpack},
    {"\x28\xb5\x2f\xfd"sv, "a zstd archive", kUnpack},
    {"\x89HDF"sv, "an HDF5 file", "export its points as PLY or LAS"},
    {"glTF"sv, "a glTF file", kWithMeshTool},
    {"<VTKFile"sv, "a VTK XML file", "save it as legacy VTK or PLY"},
    {"solid "sv, "an STL file", kWithMeshTool},
    {"<?xml"sv, "an XML file", "give the file that holds the points"},
    {"{"sv, "a JSON file", "give the file that holds the points"},
    {"\xff\xfe"sv, "text in UTF-16", "save it as UTF-8"},
    {"\xfe\xff"sv, "text in UTF-16", "save it as UTF-8"},
};

/// Foreign files that are recognised by their extension, which is stored in Magic::bytes.
constexpr Magic kExtensions[] = {
    {".ptx"sv, "a PTX file that does not begin with the ten lines of its header", "export it again"},
    {".stl"sv, "an STL file", kWithMeshTool},
};

/// Returns the description of a file that begins with `head` if the file is of a known format that is not read; null
/// for all other files.
const Magic* foreign_format(const std::filesystem::path& path, std::string_view head) {
  for (const Magic& magic : kMagics)
    if (head.starts_with(magic.bytes)) return &magic;
  for (const Magic& magic : kExtensions)
    if (extension_of(path) == magic.bytes) return &magic;
  return nullptr;
}

bool is_foreign(const std::filesystem::path& path, std::string_view head) {
  return foreign_format(path, head) != nullptr || head.find('\0') != head.npos;
}

constexpr std::array kFormats{&kPlyFormat,    &kLasFormat,   &kLazFormat,     &kCopcFormat, &kPcdFormat,
                              &kE57Format,    &kPtxFormat,   &kVtkFormat,     &kOffFormat,  &kObjFormat,
                              &kQsplatFormat, &kTextFormat,  &kPtsFormat,     &kCsvFormat,  &kNpyPointsFormat,
                              &kNpyFormat,    &kKittiFormat, &kFloatXyzFormat};

bool is_written_as_points(const Format& format) {
  return format.content == Format::Content::points && format.create != nullptr;
}
bool is_read_as_points(const Format& format) {
  return format.content == Format::Content::points && format.open != nullptr;
}
bool has_extension(const Format& format, std::string_view extension) {
  return std::ranges::find(format.extensions, extension) != format.extensions.end();
}
/// Returns whether files with the extension are read as points of the format without --format.
bool is_read_by_extension(const Format& format, std::string_view extension) {
  return is_read_as_points(format) && format.asked_for_as.empty() && has_extension(format, extension);
}

/// Returns the format that --format NAME means; null for "" and for other words.
const Format* format_asked_for(std::string_view name) {
  for (const Format* format : kFormats)
    if (!name.empty() && format->asked_for_as == name) return format;
  return nullptr;
}

/// The beginning of the word for text whose columns are stated: "text:x,y,z,-,intensity".
constexpr std::string_view kColumnsStated = "text:";

/// Returns the columns that a word such as "text:x,y,z" states; empty for a word that states none. Throws UsageError
/// unless the columns include x, y and z, and no name twice, or if a name is empty or has a space.
std::vector<std::string> stated_columns(std::string_view name) {
  if (!name.starts_with(kColumnsStated)) return {};
  name.remove_prefix(kColumnsStated.size());
  std::vector<std::string> columns(1);
  for (const char c : name) c == ',' ? void(columns.emplace_back()) : columns.back().push_back(c);
  Schema schema;
  for (const std::string& column : columns) {
    if (column.empty() || column.find_first_of(" \t") != column.npos)
      fail_usage("--columns: '{}' is not a list of names such as x,y,z,intensity,-,red,green,blue (- skips a column).",
                 name);
    if (column == "-") continue;
    if (const auto same = schema.find(column))
      fail_usage("--columns: '{}' and '{}' name the same attribute; name each once, or skip a column with -.",
                 schema.fields[*same].name, column);
    schema.append(column, Type::f64);
  }
  for (const char* axis : {"x", "y", "z"})
    if (!schema.find(axis)) fail_usage("--columns: '{}' does not name {}; a point needs x, y and z.", name, axis);
  return columns;
}

/// Returns whether a file has the extension of a format that is read without --format.
bool names_format(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  return std::ranges::any_of(kFormats, [&](const Format* format) {
    return format->asked_for_as.empty() && has_extension(*format, extension);
  });
}

/// Returns the first 4,096 bytes of a file, which are enough to recognise its format.
std::string head_of(const InputFile& file) {
  std::string head(4096, '\0');
  head.resize(file.read_some(0, std::as_writable_bytes(std::span(head))));
  return head;
}

std::string head_of(const std::filesystem::path& path, const InputFile& file) {
  if (file.size() == 0) fail("{}: is empty (0 bytes); it was perhaps not written or copied completely.", path.string());
  return head_of(file);
}

/// Returns the names of the formats for which `chosen` is true, each once: separated by ", ", the last two by `last`.
template <class Chosen>
std::string names_of(Chosen chosen, std::string_view last) {
  std::vector<std::string_view> names;
  for (const Format* format : kFormats)
    if (chosen(*format) && std::ranges::find(names, format->name) == names.end()) names.push_back(format->name);
  const std::string_view end = names.empty() ? "" : names.back();
  if (!names.empty()) names.pop_back();
  return fmt::format("{}{}{}", fmt::join(names, ", "), names.empty() ? "" : last, end);
}

std::string names_asked_for(std::string_view separator) {
  std::vector<std::string_view> names;
  for (const Format* format : kFormats)
    if (!format->asked_for_as.empty()) names.push_back(format->asked_for_as);
  return fmt::format("{}", fmt::join(names, separator));
}

/// Throws Error for a file that begins with `head` if the file is binary or of a known format that is not read. The
/// message names the format and a remedy; for a binary file, the readable formats with signatures and the formats that
/// --format can name.
void refuse_foreign_format(const std::filesystem::path& path, std::string_view head) {
  if (const Magic* const magic = foreign_format(path, head))
    fail("{}: is {}, which pointsweep does not read; {}.", path.string(), magic->what, magic->remedy);
  const std::size_t zero = head.find('\0');
  if (zero == head.npos) return;
  fail(
      "{}: is binary (byte {} is 0) but neither {}; convert it to one of these, or, if it is nothing but float32 "
      "records, name their format with --format {}.",
      path.string(), zero, names_of([](const Format& f) { return is_read_as_points(f) && f.is; }, " nor "),
      names_asked_for(" or "));
}

/// Returns whether files with this extension hold points; those with .bin do if --format names a format without
/// signature. Objects on servers are judged by their extension alone, since opening each would cost a request.
bool is_named_as_points(const std::string& extension, std::string_view format_name) {
  if (format_asked_for(format_name) != nullptr && extension == ".bin") return true;
  return std::ranges::any_of(kFormats, [&](const Format* f) { return is_read_by_extension(*f, extension); });
}

void warn_of_lost_crs(const Format& format, const OutputPlan& plan, Writer& writer) {
  if (!plan.crs || format.holds_crs) return;
  const auto keeps = [](const Format& other) {
    return is_written_as_points(other) && other.is_built_in() && other.holds_crs;
  };
  writer.add_warning(fmt::format("{}: {} cannot hold the coordinate reference system, {}; {} keep it.",
                                 plan.path.string(), format.name, short_text(*plan.crs), names_of(keeps, " and ")));
}

std::string row_of(const Format& format) {
  const bool points = format.content == Format::Content::points;
  const auto answer = [&](bool yes) { return points ? (yes ? "yes" : "no") : ""; };
  const std::string extensions =
      format.extensions.empty() ? "" : fmt::format("`{}`", fmt::join(format.extensions, " "));
  return fmt::format("| {}{} | {} | {} | {} | {} | {} | {} |\n", format.title,
                     format.details.empty() ? "" : fmt::format(" ([details]({}))", format.details), format.reads,
                     format.writes, extensions, answer(format.holds_crs), answer(format.holds_provenance),
                     points ? (format.real_coordinates ? "float64, NaN" : "integers on a grid") : "");
}

}  // namespace

#if POINTSWEEP_CODECS
bool has_codecs() { return true; }
#else
bool has_codecs() { return false; }
#endif

std::span<const Format* const> formats() { return kFormats; }

std::string extension_of(const std::filesystem::path& path) {
  const std::filesystem::path file = file_name(path);
  const std::string name = in_lower_case(file.string());
  for (const Format* format : kFormats)
    for (const std::string_view extension : format->extensions)
      if (std::ranges::count(extension, '.') > 1 && name.ends_with(extension) && name != extension)
        return std::string(extension);
  return in_lower_case(file.extension().string());
}

const Format* format_of_output(const std::filesystem::path& path) {
  if (is_standard_stream(path)) return &kPlyFormat;
  const std::string extension = extension_of(path);
  for (const Format* format : kFormats)
    if (format->create != nullptr && has_extension(*format, extension)) return format;
  return nullptr;
}

void require_output_name(const std::filesystem::path& output) {
  const Format* const format = format_of_output(output);
  if (format != nullptr && is_standard_output(output) && !format->is_sequential)
    fail_usage(
        "-: {} cannot be written to standard output, since its header is completed last; name a file, or choose "
        "another format, e.g. --output-format ply or csv.",
        format->name);
}

const Format& point_format_of_output(const std::filesystem::path& output) {
  require_output_name(output);
  const Format* const format = format_of_output(output);
  if (format != nullptr && is_written_as_points(*format)) return *format;
  const std::string extension = extension_of(output);
  fail_usage("{}: cannot write {}; use {}{}.", output.string(),
             extension.empty() ? "a file without an extension" : extension, fmt::join(writable_extensions(), ", "),
             extension.empty() ? ", or end the name of a folder of outputs with '/'" : "");
}

const Format& array_format() { return kNpyFormat; }

bool has_output_format(const std::filesystem::path& output) { return format_of_output(output) != nullptr; }

bool writes_points_to(const std::filesystem::path& output) {
  const Format* const format = format_of_output(output);
  return format != nullptr && format->content == Format::Content::points && format->is_built_in();
}

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
    const std::string name(format->is_built_in() ? format->codec : format->name);
    if (!names.ends_with(name)) names += fmt::format("{}{}", names.empty() ? "" : ", ", name);
  }
  if (missing.empty()) return there.empty() ? "none" : there;
  return fmt::format("{} (no {})", there.empty() ? "none" : there, missing);
}

std::string formats_asked_for() { return names_asked_for("|"); }

void require_format_asked_for(std::string_view name) {
  if (!name.empty() && stated_columns(name).empty() && !chooses_levels(name) && format_asked_for(name) == nullptr)
    fail_usage("--format: '{}' is not one of {}; other formats are recognised by the content of a file.", name,
               formats_asked_for());
}

std::unique_ptr<Reader> open_reader(const std::filesystem::path& named, std::string_view format_name) {
  const std::filesystem::path path = known_place(named);
  require_format_asked_for(format_name);
  if (chooses_levels(format_name)) return with_chosen_levels(open_reader(path), format_name);
  const InputFile file(path);  // stays open until the reader has opened the path
  const std::string head = head_of(path, file);
  if (const Format* const asked = format_asked_for(format_name); asked != nullptr && !names_format(path))
    return asked->open(path);
  for (const Format* format : kFormats)
    if (is_read_as_points(*format) && format->is != nullptr && format->is(head)) return format->open(path);
  refuse_foreign_format(path, head);
  const std::vector<std::string> columns = stated_columns(format_name);
  for (const Format* format : kFormats) {
    if (!is_read_as_points(*format) || format->is != nullptr || !format->asked_for_as.empty()) continue;
    if (columns.empty()) return format->open(path);
    if (format->open_columns != nullptr) return format->open_columns(path, columns);
  }
  fail("{}: is of no format that pointsweep reads.", path.string());
}

bool is_point_file(const std::filesystem::path& path, std::string_view format_name) {
  const std::string extension = extension_of(path);
  if (is_url(path)) return is_named_as_points(extension, format_name);
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;  // reading a pipe would block
  const InputFile file(path);
  if (format_asked_for(format_name) != nullptr && extension == ".bin") return true;
  for (const Format* format : kFormats)
    if (is_read_by_extension(*format, extension) && (format->is != nullptr || file.size() == 0)) return true;
  const std::string head = head_of(file);
  for (const Format* format : kFormats)
    if (is_read_as_points(*format) && format->is != nullptr && format->is(head)) return true;
  if (is_foreign(path, head)) return false;
  const std::vector<std::string> columns = stated_columns(format_name);
  return std::ranges::any_of(
      kFormats, [&](const Format* f) { return is_read_as_points(*f) && f->fits && f->fits(path, columns); });
}

std::unique_ptr<Writer> create_writer(const OutputPlan& plan) {
  const Format& format = point_format_of_output(plan.path);
  std::unique_ptr<Writer> writer = format.create(plan);
  warn_of_lost_crs(format, plan, *writer);
  return writer;
}

std::vector<std::string_view> writable_extensions() {
  std::vector<std::string_view> extensions;
  for (const Format* format : kFormats)
    if (is_written_as_points(*format))
      extensions.insert(extensions.end(), format->extensions.begin(), format->extensions.end());
  return extensions;
}

std::string_view array_extension() { return array_format().extensions.front(); }

bool holds_point_files(const std::filesystem::path& folder) {
  return std::ranges::any_of(entries_of(folder), [](const std::filesystem::directory_entry& entry) {
    return !is_hidden(entry.path()) && is_point_file(entry.path());
  });
}

std::string formats_table() {
  std::string table =
      "| format | read | write | extensions | CRS | how it was made | coordinates |\n|---|---|---|---|---|---|---|\n";
  for (const Format* format : formats()) table += row_of(*format);
  return table;
}

}  // namespace pointsweep
