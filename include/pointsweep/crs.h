// SPDX-License-Identifier: MIT
/// Coordinate reference systems as point files state them: well-known text (WKT) or GeoTIFF keys.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/export.h"

namespace pointsweep {

/// The three GeoTIFF tags that LAS stores as VLRs 34735, 34736 and 34737.
struct GeoTiffKeys {
  /// Version, revision, minor revision, number of keys, then for each key: key, place of its value, count, value.
  std::vector<std::uint16_t> directory;
  std::vector<double> doubles;
  std::string ascii;
  bool empty() const { return directory.size() < 8; }
  friend bool operator==(const GeoTiffKeys&, const GeoTiffKeys&) = default;
};

enum class CrsKind : std::uint8_t { unknown, projected, geographic, geocentric };

struct Crs {
  std::string name;                 ///< name in the file, e.g. "NAD83 / UTM zone 10N"; empty if the file states none
  CrsKind kind = CrsKind::unknown;  ///< kind of the horizontal system, and so its unit: lengths or degrees
  int epsg = 0;                     ///< EPSG code of the horizontal system; 0 if it is not stated
  int vertical_epsg = 0;            ///< EPSG code of the heights; 0 if it is not stated
  std::string wkt;                  ///< well-known text on one line; empty if the file has only GeoTIFF keys
  GeoTiffKeys geotiff;              ///< GeoTIFF keys; empty if the file has only WKT
};

/// A statement about the coordinate reference system of points. It changes no coordinate.
struct StatedCrs {
  std::optional<Crs> crs = {};  ///< the stated system; if absent, outputs state no system
  bool replaces = false;        ///< true to accept inputs with another system and to ignore their system
};

/// Returns the system that `text` names: "EPSG:2154", "EPSG:2154+5720" (with heights), WKT, or a file of WKT such as a
/// .prj; nullopt for "none". A code becomes GeoTIFF keys, since the library has no registry with the WKT of codes.
/// Throws UsageError, beginning with `where`, for anything else and for codes that GeoTIFF keys cannot state.
POINTSWEEP_EXPORT std::optional<Crs> parse_crs(const std::string& text, std::string_view where = "--crs");

/// Parses well-known text of one or several lines. For a text that is not WKT, the result has no name, kind or codes.
POINTSWEEP_EXPORT Crs crs_of_wkt(std::string_view wkt);

/// Returns a text like "EPSG:26910 (NAD83 / UTM zone 10N)" with the known parts of it, in at most about 80 characters;
/// "an unnamed projected system" and the like without name and code.
POINTSWEEP_EXPORT std::string short_text(const Crs& crs);

/// Returns "m", "ft" or "US survey ft", as stated by the system's WKT or GeoTIFF keys; empty for degrees and unknown
/// units.
POINTSWEEP_EXPORT std::string length_unit_of(const Crs& crs);

}  // namespace pointsweep
