// SPDX-License-Identifier: MIT
#include "pointsweep/formats/crs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <map>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/number_from.h"
#include "pointsweep/points/text_file.h"

namespace pointsweep {
namespace {

constexpr std::size_t kLongestName = 60;
constexpr std::uintmax_t kLongestWkt = 1 << 20;

// Keys of GeoTIFF 1.1 (OGC 19-008).
constexpr std::uint16_t kModelType = 1024, kRasterType = 1025, kCitation = 1026, kGeodeticCrs = 2048,
                        kGeodeticCitation = 2049, kProjectedCrs = 3072, kProjectedCitation = 3073, kLinearUnit = 3076,
                        kVerticalCrs = 4096, kVerticalUnit = 4099;
constexpr std::uint16_t kDoublesTag = 34736, kAsciiTag = 34737;
constexpr double kUserDefined = 32767;

/// The values of GeoTIFF keys, found by the number of the key.
struct KeyValues {
  std::map<std::uint16_t, std::vector<double>> numbers;
  std::map<std::uint16_t, std::string> texts;

  /// Returns the EPSG code that the key states; 0 if the key is missing, "undefined" or "user-defined".
  int code(std::uint16_t key) const {
    const auto found = numbers.find(key);
    if (found == numbers.end() || found->second.empty() || found->second[0] >= kUserDefined) return 0;
    return static_cast<int>(found->second[0]);
  }
  std::string text(std::initializer_list<std::uint16_t> keys) const {
    for (const std::uint16_t key : keys) {
      const auto found = texts.find(key);
      if (found != texts.end() && !found->second.empty()) return found->second;
    }
    return "";
  }
};

/// Parses "2154+5720" into two EPSG codes. The second code is 0 if the text has no '+'; an invalid code is -1.
std::pair<int, int> codes_of(std::string_view text) {
  const auto code = [](std::string_view digits) { return number_from<int>(digits).value_or(-1); };
  const std::size_t plus = text.find('+');
  return {code(text.substr(0, plus)), plus == text.npos ? 0 : code(text.substr(plus + 1))};
}

/// Returns the part of [first, first + count) that lies within `all`.
template <class Range>
Range piece(const Range& all, std::size_t first, std::size_t count) {
  first = std::min(first, all.size());
  const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
  return Range(begin, begin + static_cast<std::ptrdiff_t>(std::min(count, all.size() - first)));
}

std::string clean_citation(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  const std::size_t last = text.find_last_not_of(" |");
  const std::size_t first = text.find_first_not_of(' ');
  return last == std::string::npos ? "" : text.substr(first, last + 1 - first);
}

KeyValues values_of(const GeoTiffKeys& keys) {
  KeyValues values;
  const std::vector<std::uint16_t>& d = keys.directory;
  if (keys.empty()) return values;
  const std::size_t count = std::min<std::size_t>(d[3], d.size() / 4 - 1);
  for (std::size_t i = 4; i < 4 + 4 * count; i += 4) {
    const std::uint16_t key = d[i], place = d[i + 1], length = d[i + 2], value = d[i + 3];
    if (place == 0) {
      values.numbers[key] = {static_cast<double>(value)};
    } else if (place == kDoublesTag) {
      values.numbers[key] = piece(keys.doubles, value, length);
    } else if (place == kAsciiTag) {
      values.texts[key] = clean_citation(piece(keys.ascii, value, length));
    }
  }
  return values;
}

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

CrsKind kind_of(const WktNode& node) {
  if (is_one_of(node.keyword, {"PROJCS", "PROJCRS", "PROJECTEDCRS"})) return CrsKind::projected;
  if (is_one_of(node.keyword, {"GEOGCS", "GEOGCRS", "GEOGRAPHICCRS"})) return CrsKind::geographic;
  if (is_one_of(node.keyword, {"GEOCCS"})) return CrsKind::geocentric;
  if (!is_one_of(node.keyword, {"GEODCRS", "GEODETICCRS"})) return CrsKind::unknown;
  // WKT 2 tells geocentric from geographic systems by the coordinate system: CS[Cartesian,3] or CS[ellipsoidal,2].
  for (const WktNode& child : node.children) {
    if (child.keyword != "CS" || child.children.empty()) continue;
    return child.children[0].keyword == "CARTESIAN" ? CrsKind::geocentric : CrsKind::geographic;
  }
  return CrsKind::unknown;
}

bool is_vertical(const WktNode& node) {
  return is_one_of(node.keyword, {"VERT_CS", "VERTCS", "VERTCRS", "VERTICALCRS"});
}

/// Returns the code of AUTHORITY["EPSG","26910"] or ID["EPSG",26910] directly inside `node`; 0 if there is none.
int epsg_of(const WktNode& node) {
  for (const WktNode& child : node.children) {
    if (!is_one_of(child.keyword, {"AUTHORITY", "ID"}) || child.values.size() < 2) continue;
    if (!is_one_of(child.values[0], {"EPSG", "epsg"})) continue;
    std::string_view digits = child.values[1];
    return std::max(take_number<int>(digits).value_or(0), 0);
  }
  return 0;
}

/// Returns the system that BOUNDCRS[SOURCECRS[...], ...] wraps; `node` itself if it wraps none.
const WktNode& unwrapped(const WktNode& node) {
  if (node.keyword != "BOUNDCRS") return node;
  for (const WktNode& child : node.children) {
    if (child.keyword == "SOURCECRS" && !child.children.empty()) return child.children[0];
  }
  return node;
}

void take_node(Crs& crs, const WktNode& wrapped) {
  const WktNode& node = unwrapped(wrapped);
  if (is_one_of(node.keyword, {"COMPD_CS", "COMPOUNDCRS"})) {
    for (const WktNode& child : node.children) take_node(crs, child);
  } else if (is_vertical(node)) {
    crs.vertical_epsg = epsg_of(node);
  } else if (kind_of(node) != CrsKind::unknown) {
    crs.kind = kind_of(node);
    crs.epsg = epsg_of(node);
  }
  if (!node.values.empty() && !is_vertical(node) && (crs.kind != CrsKind::unknown || crs.name.empty()))
    crs.name = node.values[0];
}

/// Compares systems by the numbers of their keys, since citations are free texts and may differ.
CrsAgreement compare_numbers(const KeyValues& a, const KeyValues& b) {
  if (a.numbers == b.numbers) return CrsAgreement::same;
  for (const auto& [key, value] : a.numbers) {
    const auto other = b.numbers.find(key);
    if (other != b.numbers.end() && other->second != value) return CrsAgreement::different;
  }
  return CrsAgreement::undecided;
}

CrsAgreement compare_with_codes(const Crs& a, const Crs& b) {
  if (a.vertical_epsg != b.vertical_epsg)
    return a.vertical_epsg != 0 && b.vertical_epsg != 0 ? CrsAgreement::different : CrsAgreement::undecided;
  // A GeoTIFF file may override the unit of the coded system.
  const int unit = values_of(a.geotiff).code(kLinearUnit), other = values_of(b.geotiff).code(kLinearUnit);
  return unit != 0 && other != 0 && unit != other ? CrsAgreement::different : CrsAgreement::same;
}

struct LengthUnit {
  std::uint16_t code;  ///< code in the EPSG registry
  double metres;
  const char* name;
};

constexpr LengthUnit kLengthUnits[] = {{9001, 1, "m"}, {9002, 0.3048, "ft"}, {9003, 1200.0 / 3937, "US survey ft"}};

/// Returns the entry of kLengthUnits with this length; null for all other numbers, e.g. the 0.01745 of a degree.
const LengthUnit* unit_of_metres(double metres) {
  const auto same = [&](const LengthUnit& unit) { return std::abs(metres - unit.metres) < 1e-9; };
  const auto found = std::ranges::find_if(kLengthUnits, same);
  return found == std::end(kLengthUnits) ? nullptr : found;
}

enum class Along : std::uint8_t { map, heights };

/// Returns the last unit of length along the map or of heights in a system or in a part of it; null if there is none.
/// `part`: heights if `node` is inside a vertical system. WKT 1 has UNIT, WKT 2 LENGTHUNIT. The last unit counts, since
/// the unit of a projected system comes after the units of its ellipsoid (WKT 2), its angles and the parameters of its
/// projection.
const LengthUnit* unit_of_node(const WktNode& node, Along along, Along part = Along::map) {
  if (is_vertical(node)) part = Along::heights;
  if (is_one_of(node.keyword, {"UNIT", "LENGTHUNIT"}) && node.values.size() > 1) {
    if (part != along) return nullptr;
    std::string_view factor = node.values[1];
    const auto metres = take_number<double>(factor);
    return metres ? unit_of_metres(*metres) : nullptr;
  }
  const LengthUnit* unit = nullptr;
  for (const WktNode& child : node.children)
    if (const LengthUnit* found = unit_of_node(child, along, part)) unit = found;
  return unit;
}

const LengthUnit* unit_of(const Crs& crs, Along along = Along::map) {
  if (crs.kind == CrsKind::geographic) return nullptr;
  const std::optional<WktNode> root = parse_wkt(crs.wkt);
  if (const LengthUnit* unit = root ? unit_of_node(unwrapped(*root), along) : nullptr) return unit;
  const int code = values_of(crs.geotiff).code(along == Along::map ? kLinearUnit : kVerticalUnit);
  const auto found = std::ranges::find(kLengthUnits, code, &LengthUnit::code);
  return found == std::end(kLengthUnits) ? nullptr : found;
}

}  // namespace

Crs crs_of_wkt(std::string_view wkt) {
  Crs crs;
  crs.wkt = wkt_in_one_line(wkt);
  if (const std::optional<WktNode> root = parse_wkt(crs.wkt)) {
    take_node(crs, *root);
    const WktNode& node = unwrapped(*root);
    if (!node.values.empty()) crs.name = node.values[0];
  }
  return crs;
}

Crs crs_of_geotiff(GeoTiffKeys keys) {
  const KeyValues values = values_of(keys);
  Crs crs;
  const int model = values.code(kModelType);
  const int projected = values.code(kProjectedCrs), geodetic = values.code(kGeodeticCrs);
  if (model == 1 || (model == 0 && projected != 0)) {
    crs.kind = CrsKind::projected;
  } else if (model == 2 || (model == 0 && geodetic != 0)) {
    crs.kind = CrsKind::geographic;
  } else if (model == 3) {
    crs.kind = CrsKind::geocentric;
  }
  crs.epsg = crs.kind == CrsKind::projected ? projected : crs.kind == CrsKind::unknown ? 0 : geodetic;
  crs.vertical_epsg = values.code(kVerticalCrs);
  crs.name = crs.kind == CrsKind::projected ? values.text({kProjectedCitation, kCitation})
                                            : values.text({kCitation, kGeodeticCitation});
  crs.geotiff = std::move(keys);
  return crs;
}

GeoTiffKeys geotiff_of_epsg(int epsg, int vertical_epsg) {
  const bool is_projected = kind_of_epsg(epsg) == CrsKind::projected;
  std::vector<std::array<int, 2>> keys = {
      {kModelType, is_projected ? 1 : 2}, {kRasterType, 1}, {is_projected ? kProjectedCrs : kGeodeticCrs, epsg}};
  if (vertical_epsg != 0) keys.push_back({kVerticalCrs, vertical_epsg});
  GeoTiffKeys made{.directory = {1, 1, 0, static_cast<std::uint16_t>(keys.size())}, .doubles = {}, .ascii = {}};
  for (const auto& [key, value] : keys)
    for (const int entry : {key, 0, 1, value}) made.directory.push_back(static_cast<std::uint16_t>(entry));
  return made;
}

std::optional<Crs> parse_crs(const std::string& text, std::string_view where) {
  if (text == "none") return std::nullopt;
  std::string wkt = text;
  if (text.starts_with("EPSG:") || text.starts_with("epsg:")) {
    const auto [epsg, heights] = codes_of(std::string_view(text).substr(5));
    if (kind_of_epsg(epsg) == CrsKind::unknown || heights < 0 || heights >= kUserDefined)
      fail_usage(
          "{}: '{}' is not the code of a projected or geographic system, e.g. EPSG:2154, or EPSG:2154+5720 with "
          "heights; for others give a file with WKT.",
          where, text);
    return crs_of_geotiff(geotiff_of_epsg(epsg, heights));
  }
  std::error_code error;
  if (std::filesystem::is_regular_file(text, error)) {
    if (std::filesystem::file_size(text, error) > kLongestWkt) fail_usage("{}: {} is too long for WKT.", where, text);
    std::ifstream file(text);
    wkt.assign(std::istreambuf_iterator<char>(file), {});
  }
  Crs crs = crs_of_wkt(without_byte_order_mark(wkt));
  if (crs.kind == CrsKind::unknown && crs.name.empty())
    fail_usage("{}: '{}' is neither EPSG:CODE, nor a file with WKT, nor none.", where, text.substr(0, kLongestName));
  return crs;
}

std::optional<Crs> crs_of_both(const std::string& wkt, GeoTiffKeys keys, bool wkt_counts) {
  Crs text = crs_of_wkt(wkt), coded = crs_of_geotiff(keys);
  if (text.wkt.empty() && coded.geotiff.empty()) return std::nullopt;
  if (text.wkt.empty()) return coded;
  if (coded.geotiff.empty()) return text;
  Crs& crs = wkt_counts ? text : coded;
  crs.wkt = text.wkt;
  crs.geotiff = std::move(keys);
  return crs;
}

std::string short_text(const Crs& crs) {
  std::string name = crs.name.substr(0, kLongestName);
  if (name.size() < crs.name.size()) name += "...";
  std::string code = crs.epsg != 0 ? fmt::format("EPSG:{}", crs.epsg) : "";
  if (!code.empty() && crs.vertical_epsg != 0) code += fmt::format("+{}", crs.vertical_epsg);
  if (!code.empty()) return name.empty() ? code : fmt::format("{} ({})", code, name);
  if (!name.empty()) return fmt::format("'{}'", name);
  static constexpr const char* kKinds[] = {"an unnamed system", "an unnamed projected system",
                                           "an unnamed geographic system", "an unnamed geocentric system"};
  return kKinds[static_cast<std::size_t>(crs.kind)];
}

CrsAgreement compare(const Crs& a, const Crs& b) {
  if (a.kind != b.kind && a.kind != CrsKind::unknown && b.kind != CrsKind::unknown) return CrsAgreement::different;
  if (a.epsg != 0 && b.epsg != 0 && a.epsg != b.epsg) return CrsAgreement::different;
  if (!a.wkt.empty() && a.wkt == b.wkt) return CrsAgreement::same;
  if (!a.geotiff.empty() && a.geotiff == b.geotiff) return CrsAgreement::same;
  if (a.epsg != 0 && b.epsg != 0) return compare_with_codes(a, b);
  if (a.geotiff.empty() || b.geotiff.empty()) return CrsAgreement::undecided;
  return compare_numbers(values_of(a.geotiff), values_of(b.geotiff));
}

std::string length_unit_of(const Crs& crs) {
  const LengthUnit* unit = unit_of(crs);
  return unit != nullptr ? unit->name : "";
}

std::optional<UnitOfHeights> other_unit_of_heights(const Crs& crs) {
  const LengthUnit *map = unit_of(crs), *heights = unit_of(crs, Along::heights);
  if (map == nullptr || heights == nullptr) return std::nullopt;
  const double ratio = heights->metres / map->metres;
  return std::abs(ratio - 1) > 1e-5 ? std::optional(UnitOfHeights{heights->name, ratio}) : std::nullopt;
}

std::optional<double> metres_of_unit(const Crs& crs) {
  const LengthUnit* unit = unit_of(crs);
  return unit != nullptr ? std::optional(unit->metres) : std::nullopt;
}

}  // namespace pointsweep
