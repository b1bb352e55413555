// SPDX-License-Identifier: MIT
/// Comments of PLY headers with facts for which PLY has no other place, so that LAS -> PLY -> LAS keeps the coordinate
/// reference system, the grid of the coordinates and the kind of GPS times.
///
///     comment crs PROJCS["NAD83 / UTM zone 10N",...    the WKT; longer than 900 bytes, it continues in the next `crs`
///     comment crs_geotiff_keys 1 1 0 3 1024 0 1 1 ...  GeoKeyDirectoryTag
///     comment crs_geotiff_doubles 6378137 298.25       GeoDoubleParamsTag
///     comment crs_geotiff_ascii NAD83|                 GeoAsciiParamsTag; '%' and all but visible characters as %XX
///     comment las scale 0.01 0.01 0.01 offset 500000 0 0 gps_time standard
///                                                      grid of a LAS input, and the kind of its GPS times, if it has
///                                                      any: `standard` or `week`
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <string_view>
#include <utility>

#include "pointsweep/formats/crs.h"
#include "pointsweep/formats/files/number_text.h"
#include "pointsweep/formats/ply/ply_format.h"

namespace pointsweep {
namespace {

/// The widespread reader rply refuses lines of 1,024 bytes.
constexpr std::size_t kLongestPiece = 900;

constexpr std::string_view kLas = "comment las ", kWkt = "comment crs ", kKeys = "comment crs_geotiff_keys ",
                           kDoubles = "comment crs_geotiff_doubles ", kAscii = "comment crs_geotiff_ascii ";

/// Returns lines of `prefix` and a piece of `text` each. No piece begins or ends with a space, since readers may trim
/// lines.
std::vector<std::string> in_pieces(std::string_view prefix, std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    std::size_t size = std::min(text.size(), kLongestPiece);
    while (size < text.size() && size > 1 && (text[size] == ' ' || text[size - 1] == ' ')) --size;
    lines.push_back(std::string(prefix) + std::string(text.substr(0, size)));
    text.remove_prefix(size);
  }
  return lines;
}

/// Returns lines of numbers separated by spaces, each as long as possible.
template <class Numbers>
std::vector<std::string> number_lines(std::string_view prefix, const Numbers& numbers) {
  std::vector<std::string> lines;
  for (const auto number : numbers) {
    const std::string text = fmt::format("{}", number);
    if (lines.empty() || lines.back().size() + text.size() > kLongestPiece) {
      lines.push_back(std::string(prefix) + text);
    } else {
      lines.back() += " " + text;
    }
  }
  return lines;
}

/// Returns `text` with '%', spaces and all bytes that are not visible ASCII as %XX. Readers would trim spaces.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte <= 0x20 || byte >= 0x7f || c == '%') {
      out += fmt::format("%{:02X}", byte);
    } else {
      out += c;
    }
  }
  return out;
}

std::optional<std::string> unescaped(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    if (i + 2 >= text.size()) return std::nullopt;
    const auto digit = [](char c) { return std::string_view("0123456789ABCDEF").find(c); };
    const std::size_t high = digit(text[i + 1]), low = digit(text[i + 2]);
    if (high == std::string_view::npos || low == std::string_view::npos) return std::nullopt;
    out += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return out;
}

/// Returns the text after `prefix` in all lines that begin with it, joined by `between`.
std::string joined(const std::vector<std::string>& lines, std::string_view prefix, std::string_view between) {
  std::string text;
  for (const std::string& line : lines) {
    if (!line.starts_with(prefix)) continue;
    if (!text.empty()) text += between;
    text += line.substr(prefix.size());
  }
  return text;
}

template <class T>
std::optional<std::vector<T>> numbers_of(std::string_view text) {
  std::vector<T> numbers;
  for (const std::string_view word : words_in(text))
    if (!parse_number(word, numbers.emplace_back())) return std::nullopt;
  return numbers;
}

void remove_lines(std::vector<std::string>& lines, std::initializer_list<std::string_view> prefixes) {
  std::erase_if(lines, [&](const std::string& line) {
    return std::ranges::any_of(prefixes, [&](std::string_view p) { return line.starts_with(p); });
  });
}

void append_lines(std::vector<std::string>& all, std::vector<std::string> lines) {
  std::move(lines.begin(), lines.end(), std::back_inserter(all));
}

GeoTiffKeys take_geotiff(std::vector<std::string>& lines) {
  const auto directory = numbers_of<std::uint16_t>(joined(lines, kKeys, " "));
  const auto doubles = numbers_of<double>(joined(lines, kDoubles, " "));
  const auto ascii = unescaped(joined(lines, kAscii, ""));
  if (!directory || !doubles || !ascii || directory->size() < 8) return {};
  remove_lines(lines, {kKeys, kDoubles, kAscii});
  return {*directory, *doubles, *ascii};
}

constexpr std::string_view kOverlapWord = "class_12_is_overlap";

/// Parses three numbers from words[first] on.
bool parse_vector(const std::vector<std::string_view>& words, std::size_t first, Vec3& v) {
  return parse_number(words[first], v.x) && parse_number(words[first + 1], v.y) && parse_number(words[first + 2], v.z);
}

std::optional<LasOrigin> las_origin_in(std::string_view line) {
  const std::vector<std::string_view> words = words_in(line.substr(kLas.size()));
  LasOrigin origin;
  if (words.size() < 8) return std::nullopt;
  if (words[0] != "scale" || words[4] != "offset") return std::nullopt;
  if (!parse_vector(words, 1, origin.grid.scale) || !parse_vector(words, 5, origin.grid.offset)) return std::nullopt;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(origin.grid.scale[axis] > 0) || !std::isfinite(origin.grid.scale[axis])) return std::nullopt;
    if (!std::isfinite(origin.grid.offset[axis])) return std::nullopt;
  }
  std::size_t next = 8;
  if (next + 1 < words.size() && words[next] == "gps_time") {
    origin.has_time = true;
    origin.standard_time = words[next + 1] == "standard";
    if (!origin.standard_time && words[next + 1] != "week") return std::nullopt;
    next += 2;
  }
  if (next < words.size() && words[next] == kOverlapWord) origin.overlap_is_class_12 = true, ++next;
  return next == words.size() ? std::optional(origin) : std::nullopt;
}

}  // namespace

std::string las_comment(const LasOrigin& origin) {
  const Vec3 scale = origin.grid.scale, offset = origin.grid.offset;
  std::string line =
      fmt::format("{}scale {} {} {} offset {} {} {}", kLas, scale.x, scale.y, scale.z, offset.x, offset.y, offset.z);
  if (origin.has_time) line += origin.standard_time ? " gps_time standard" : " gps_time week";
  if (origin.overlap_is_class_12) line += fmt::format(" {}", kOverlapWord);
  return line;
}

std::optional<LasOrigin> take_las_comment(std::vector<std::string>& lines) {
  for (auto line = lines.begin(); line != lines.end(); ++line) {
    if (!line->starts_with(kLas)) continue;
    const std::optional<LasOrigin> origin = las_origin_in(*line);
    if (origin) lines.erase(line);
    return origin;
  }
  return std::nullopt;
}

std::vector<std::string> crs_comments(const Crs& crs) {
  std::vector<std::string> lines = in_pieces(kWkt, crs.wkt);
  if (crs.geotiff.empty()) return lines;
  append_lines(lines, number_lines(kKeys, crs.geotiff.directory));
  append_lines(lines, number_lines(kDoubles, crs.geotiff.doubles));
  append_lines(lines, in_pieces(kAscii, escaped(crs.geotiff.ascii)));
  return lines;
}

std::optional<Crs> take_crs_comments(std::vector<std::string>& lines) {
  Crs text = crs_of_wkt(joined(lines, kWkt, ""));
  const std::optional<WktNode> root = parse_wkt(text.wkt);
  const bool has_text = root && !root->values.empty();
  if (has_text) remove_lines(lines, {kWkt});
  GeoTiffKeys keys = take_geotiff(lines);
  if (keys.empty()) return has_text ? std::optional(text) : std::nullopt;
  Crs coded = crs_of_geotiff(keys);
  if (!has_text) return coded;
  text.geotiff = std::move(keys);
  return text;
}

}  // namespace pointsweep
