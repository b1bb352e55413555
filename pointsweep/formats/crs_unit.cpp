// SPDX-License-Identifier: MIT
#include "pointsweep/formats/crs_unit.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace pointsweep {
namespace {

constexpr std::uint16_t kLinearUnitsKey = 3076, kMetre = 9001, kFoot = 9002, kSurveyFoot = 9003;

std::string unit_of_metres(double metres) {
  if (std::abs(metres - 1) < 1e-9) return "m";
  if (std::abs(metres - 0.3048) < 1e-9) return "ft";
  if (std::abs(metres - 1200.0 / 3937) < 1e-9) return "US survey ft";
  return {};
}

/// The number of `UNIT["name",number` whose `[` is at `bracket`.
std::optional<double> factor_at(std::string_view wkt, std::size_t bracket) {
  const std::size_t open = wkt.find('"', bracket), close = open == wkt.npos ? open : wkt.find('"', open + 1);
  std::size_t begin = close == wkt.npos ? close : wkt.find(',', close);
  if (begin == wkt.npos) return std::nullopt;
  begin = wkt.find_first_not_of(' ', begin + 1);
  if (begin == wkt.npos) return std::nullopt;
  double factor = 0;
  const auto [end, error] = std::from_chars(wkt.data() + begin, wkt.data() + wkt.size(), factor);
  return error == std::errc() ? std::optional(factor) : std::nullopt;
}

/// WKT 1 writes UNIT, WKT 2 LENGTHUNIT. Before the unit of a projected system stand that of its ellipsoid (WKT 2) and
/// that of its angles, which is no length: the last length before the vertical system counts.
std::string unit_of_wkt(std::string_view wkt) {
  const std::string_view horizontal =
      wkt.substr(0, std::min({wkt.find("VERT_CS"), wkt.find("VERTCS"), wkt.find("VERTCRS"), wkt.size()}));
  std::string unit;
  for (std::size_t at = horizontal.find("UNIT["); at != horizontal.npos; at = horizontal.find("UNIT[", at + 1)) {
    const std::optional<double> factor = factor_at(horizontal, at);
    const std::string found = factor ? unit_of_metres(*factor) : "";
    if (!found.empty()) unit = found;
  }
  return unit;
}

std::string unit_of_keys(const GeoTiffKeys& keys) {
  for (std::size_t i = 4; i + 3 < keys.directory.size(); i += 4) {
    if (keys.directory[i] != kLinearUnitsKey || keys.directory[i + 1] != 0) continue;
    const std::uint16_t code = keys.directory[i + 3];
    return code == kMetre ? "m" : code == kFoot ? "ft" : code == kSurveyFoot ? "US survey ft" : "";
  }
  return {};
}

}  // namespace

std::string length_unit_of(const Crs& crs) {
  if (crs.kind == CrsKind::geographic) return {};
  const std::string unit = unit_of_wkt(crs.wkt);
  return unit.empty() ? unit_of_keys(crs.geotiff) : unit;
}

}  // namespace pointsweep
