// SPDX-License-Identifier: MIT
#include "cli/text/file_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pointsweep {
namespace {

/// Returns a text such as "ascending along x", "descending along y and z" or "not ascending along x, y or z". An axis
/// on which all coordinates are equal counts as unordered.
std::string order_text(const FileSummary& summary) {
  std::string text;
  const Vec3 extent = summary.bounds.extent();
  for (const bool up : {true, false}) {
    std::string axes;
    for (int axis = 0; axis < 3; ++axis) {
      const bool ordered = (up ? summary.ascending : summary.descending)[static_cast<std::size_t>(axis)];
      if (ordered && extent[axis] > 0)
        axes += (axes.empty() ? "" : " and ") + std::string(1, static_cast<char>('x' + axis));
    }
    if (!axes.empty())
      text += (text.empty() ? "" : ", ") + std::string(up ? "ascending along " : "descending along ") + axes;
  }
  return text.empty() ? "not ascending along x, y or z" : text;
}

std::string line(const char* name, const std::string& value) { return fmt::format("  {:<10}  {}\n", name, value); }

bool is_coordinate(const Schema& schema, std::size_t field) {
  const auto is = [&](const char* name) { return schema.find(name) == field; };
  return is("x") || is("y") || is("z");
}

/// Returns lines with the scale and offset of the coordinates; empty if all scales are 1 and all offsets 0.
std::string storage_text(const Schema& schema) {
  const Field &x = schema.fields[*schema.find("x")], &y = schema.fields[*schema.find("y")],
              &z = schema.fields[*schema.find("z")];
  if (x.scale == 1 && y.scale == 1 && z.scale == 1 && x.bias == 0 && y.bias == 0 && z.bias == 0) return {};
  return line("scale", fmt::format("{:g} {:g} {:g}", x.scale, y.scale, z.scale)) +
         line("offset",
              fmt::format("{:.15g} {:.15g} {:.15g}", x.bias + 0.0, y.bias + 0.0, z.bias + 0.0));  // -0 becomes 0
}

std::string density_text(const FileSummary& s) {
  std::string text;
  if (const auto density = s.density()) {
    text += line("density", fmt::format("{:.4g} points per square unit of x and y (occupied cells of side {:g})",
                                        *density, s.cell_side));
  }
  if (const auto spacing = s.spacing()) {
    text += line("spacing", fmt::format("{:.4g}, median distance to the nearest other point ({} points sampled)",
                                        *spacing, s.nearest.size()));
  }
  if (const std::size_t equal = s.duplicates(); equal > 0)
    text += line("duplicates", fmt::format("{} of {} sampled points", equal, s.nearest.size()));
  return text;
}

std::string counts_text(const FileSummary& s) {
  std::string classes, returns;
  for (std::size_t code = 0; code < s.classes.size(); ++code) {
    if (s.classes[code] == 0) continue;
    classes += fmt::format("{}{}: {}", classes.empty() ? "" : ", ", text_of_class(static_cast<std::uint8_t>(code)),
                           s.classes[code]);
  }
  for (std::size_t number = 0; number < s.returns.size(); ++number)
    if (s.returns[number] > 0)
      returns += fmt::format("{}{}: {}", returns.empty() ? "" : ", ", number, s.returns[number]);
  return (classes.empty() ? "" : line("classes", classes)) + (returns.empty() ? "" : line("returns", returns));
}

std::string gps_text(const FileSummary& s) {
  const auto times = gps_times(s);
  if (!times) return {};
  std::string text = fmt::format("{:.15g} .. {:.15g}", times->lo, times->hi);
  if (times->clock == GpsClock::adjusted_standard)
    text += fmt::format(" (adjusted standard: {} .. {})", gps_date(times->lo), gps_date(times->hi));
  if (times->clock == GpsClock::week_seconds) text += " (seconds of the GPS week)";
  return line("gps time", text);
}

/// Returns the text; of a text longer than kMost, such as one that holds a polygon of many points, only the beginning
/// and the end, and between them the number of characters left out.
std::string shortened(const std::string& text) {
  constexpr std::size_t kMost = 2000, kBegin = 1500, kEnd = 400;
  if (text.size() <= kMost) return text;
  return fmt::format("{} [{} characters] {}", text.substr(0, kBegin), text.size() - kBegin - kEnd,
                     text.substr(text.size() - kEnd));
}

/// Returns one line for each run that made the file, oldest first. `info --json` prints them unshortened.
std::string provenance_text(const FileInfo& info) {
  std::string text;
  for (const std::string& run : made_by(info)) text += line("made by", shortened(run));
  return text;
}

/// Returns a line with the range of each attribute except the coordinates.
std::string ranges_text(const Schema& schema, const FileSummary& s) {
  std::size_t widest = 0;
  for (std::size_t f = 0; f < schema.fields.size(); ++f)
    if (!is_coordinate(schema, f)) widest = std::max(widest, schema.fields[f].name.size());
  std::string text;
  for (std::size_t f = 0; f < schema.fields.size(); ++f) {
    if (is_coordinate(schema, f)) continue;
    const FieldRange& r = s.ranges[f];
    std::string values = r.lo <= r.hi ? fmt::format("{:.9g} .. {:.9g}", r.lo, r.hi) : "no finite value";
    if (r.lo == r.hi) values = fmt::format("{:.9g}", r.lo);
    if (r.nonfinite > 0) values += fmt::format(", {} not finite", r.nonfinite);
    text += fmt::format("    {:<{}}  {}\n", schema.fields[f].name, widest, values);
  }
  return text.empty() ? text : "  ranges\n" + text;
}

/// Returns the code of a coordinate reference system, e.g. "EPSG:25832", with the code of its heights if it states one;
/// the name of a system without a code, or "without a name"; "-" for no system.
std::string cell_of(const std::optional<Crs>& crs) {
  if (!crs) return "-";
  if (crs->epsg != 0)
    return fmt::format("EPSG:{}", crs->epsg) + (crs->vertical_epsg != 0 ? fmt::format("+{}", crs->vertical_epsg) : "");
  return crs->name.empty() ? "without a name" : crs->name;
}

/// Returns the bounds along the axis, with enough decimals to show a ten-thousandth of their distance, at most 9.
std::string cell_of_axis(const Box& bounds, int axis) {
  if (bounds.empty()) return "-";
  const double lo = bounds.lo[axis] + 0.0, hi = bounds.hi[axis] + 0.0;  // -0 becomes 0
  if (!(hi > lo)) return fmt::format("{:.9g}", lo);
  const int decimals = static_cast<int>(std::clamp(4 - std::floor(std::log10(hi - lo)), 0.0, 9.0));
  return fmt::format("{:.{}f} .. {:.{}f}", lo, decimals, hi, decimals);
}

/// Returns the position of `list` in `lists`, counted from 1. Appends `list` to `lists` if it is new.
std::size_t number_of(std::vector<std::string>& lists, const std::string& list) {
  const auto at = std::ranges::find(lists, list);
  const auto number = static_cast<std::size_t>(at - lists.begin()) + 1;
  if (at == lists.end()) lists.push_back(list);
  return number;
}

std::vector<std::string> line_of(const FileSummary& file, std::vector<std::string>& lists) {
  const std::optional<double> density = file.density();
  return {file.info.path.string(),      std::to_string(file.info.count),
          cell_of_axis(file.bounds, 0), cell_of_axis(file.bounds, 1),
          cell_of_axis(file.bounds, 2), density ? fmt::format("{:.4g}", *density) : "-",
          cell_of(file.info.crs),       fmt::format("({})", number_of(lists, attribute_text(file.info.schema)))};
}

}  // namespace

/// Returns the names of the attributes, with one type for successive attributes of equal type.
std::string attribute_text(const Schema& schema) {
  std::string text;
  for (std::size_t f = 0; f < schema.fields.size(); ++f) {
    const Field& field = schema.fields[f];
    text += field.name + (field.count > 1 ? fmt::format("[{}]", field.count) : "") + " ";
    const bool run_ends = f + 1 == schema.fields.size() || schema.fields[f + 1].type != field.type;
    if (run_ends) text += std::string(name_of(field.type)) + (f + 1 == schema.fields.size() ? "" : ", ");
  }
  return text;
}

std::string to_text(std::uint64_t points, const Box& bounds) {
  std::string text = fmt::format("  points      {}\n", points);
  if (bounds.empty()) return text;
  for (int axis = 0; axis < 3; ++axis)
    text += fmt::format("  {}           {:.15g} .. {:.15g}\n", "xyz"[axis], bounds.lo[axis], bounds.hi[axis]);
  return text;
}

std::string to_text(const FileSummary& summary) {
  const FileInfo& info = summary.info;
  std::string text = fmt::format("{}\n", info.path.string());
  text += line("format", fmt::format("{}, {} bytes", info.format, info.bytes)) + provenance_text(info);
  if (info.crs) text += line("crs", short_text(*info.crs));
  text += to_text(info.count, summary.bounds);
  if (summary.nonfinite > 0) text += line("not finite", fmt::format("{} points, not in the bounds", summary.nonfinite));
  text += storage_text(info.schema);
  if (summary.of_header)
    return text + line("attributes", attribute_text(info.schema)) +
           line("read", "the header alone, which states the bounds");
  text += density_text(summary);
  text += line("order", order_text(summary)) + counts_text(summary) + gps_text(summary);
  return text + line("attributes", attribute_text(info.schema)) + ranges_text(info.schema, summary);
}

std::string TextTable::text() const {
  std::vector<std::size_t> widths(lines_.front().size(), 0);
  for (const auto& line : lines_)
    for (std::size_t c = 0; c < line.size(); ++c) widths[c] = std::max(widths[c], line[c].size());
  std::string text;
  for (const auto& line : lines_) {
    std::string row = indent_;
    for (std::size_t c = 0; c < line.size(); ++c) {
      const bool is_left = std::ranges::find(left_, c) != left_.end();
      row += (c == 0 ? "" : "  ") +
             (is_left ? fmt::format("{:<{}}", line[c], widths[c]) : fmt::format("{:>{}}", line[c], widths[c]));
    }
    text += row.substr(0, row.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

void FileTable::add(const FileSummary& file) { lines_.add(line_of(file, lists_)); }

void FileTable::add_unreadable(const std::filesystem::path& file) { lines_.add({file.string(), "cannot be read"}); }

std::string FileTable::text() const {
  std::string text = lines_.text();
  for (std::size_t i = 0; i < lists_.size(); ++i) text += fmt::format("attributes ({})  {}\n", i + 1, lists_[i]);
  return text;
}

void FileTotals::add(const FileSummary& file) {
  ++readable_;
  points_ += file.info.count;
  bounds_.include(file.bounds);
  if (file.area > 0) points_on_area_ += static_cast<double>(file.info.count - file.nonfinite);
  area_ += file.area;
  of_headers_ |= file.of_header;
}

std::optional<double> FileTotals::density() const {
  return area_ > 0 ? std::optional(points_on_area_ / area_) : std::nullopt;
}

std::string FileTotals::text(const std::vector<std::string>& inconsistencies) const {
  std::string text =
      unreadable_ == 0 ? fmt::format("all {} files\n", readable_) : fmt::format("{} of {} files\n", readable_, files());
  text += to_text(points_, bounds_);
  if (const auto all = density()) text += fmt::format("  density     {:.4g} points per square unit of x and y\n", *all);
  if (of_headers_) text += "  read        the headers alone, which state the bounds\n";
  if (readable_ > 1 && inconsistencies.empty()) text += "  The files are consistent.\n";
  if (!inconsistencies.empty()) text += "  inconsistent\n";
  for (const std::string& sentence : inconsistencies) text += fmt::format("    {}\n", sentence);
  return text;
}

}  // namespace pointsweep
