// SPDX-License-Identifier: MIT
#include "pointsweep/formats/crs_unit.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace pointsweep {
namespace {

constexpr std::uint16_t kLinearUnitsKey = 3076;

struct LengthUnit {
  std::uint16_t code;  ///< of the EPSG registry
  double metres;
  const char* name;
};

constexpr LengthUnit kLengthUnits[] = {
    {9001, 1, "m"}, {9002, 0.3048, "ft"}, {9003, 1200.0 / 3937, "US survey ft"}};

/// Null for a number that is that of no length unit, as of a degree, which is 0.01745 radians.
const LengthUnit* unit_of_metres(double metres) {
  const auto same = [&](const LengthUnit& unit) { return std::abs(metres - unit.metres) < 1e-9; };
  const auto found = std::ranges::find_if(kLengthUnits, same);
  return found == std::end(kLengthUnits) ? nullptr : found;
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
const LengthUnit* unit_of_wkt(std::string_view wkt) {
  const std::string_view horizontal =
      wkt.substr(0, std::min({wkt.find("VERT_CS"), wkt.find("VERTCS"), wkt.find("VERTCRS"), wkt.size()}));
  const LengthUnit* unit = nullptr;
  for (std::size_t at = horizontal.find("UNIT["); at != horizontal.npos; at = horizontal.find("UNIT[", at + 1)) {
    const std::optional<double> factor = factor_at(horizontal, at);
    const LengthUnit* found = factor ? unit_of_metres(*factor) : nullptr;
    if (found != nullptr) unit = found;
  }
  return unit;
}

const LengthUnit* unit_of_keys(const GeoTiffKeys& keys) {
  for (std::size_t i = 4; i + 3 < keys.directory.size(); i += 4) {
    if (keys.directory[i] != kLinearUnitsKey || keys.directory[i + 1] != 0) continue;
    const auto found = std::ranges::find(kLengthUnits, keys.directory[i + 3], &LengthUnit::code);
    return found == std::end(kLengthUnits) ? nullptr : found;
  }
  return nullptr;
}

const LengthUnit* unit_of(const Crs& crs) {
  if (crs.kind == CrsKind::geographic) return nullptr;
  const LengthUnit* unit = unit_of_wkt(crs.wkt);
  return unit != nullptr ? unit : unit_of_keys(crs.geotiff);
}

}  // namespace

std::string length_unit_of(const Crs& crs) {
  const LengthUnit* unit = unit_of(crs);
  return unit != nullptr ? unit->name : "";
}

std::optional<double> metres_of_unit(const Crs& crs) {
  const LengthUnit* unit = unit_of(crs);
  return unit != nullptr ? std::optional(unit->metres) : std::nullopt;
}

}  // namespace pointsweep
