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
  /// Version, revision, minor revision, n, then n times key, place, count, value.
  std::vector<std::uint16_t> directory;
  std::vector<double> doubles;
  std::string ascii;
  bool empty() const { return directory.size() < 8; }
  friend bool operator==(const GeoTiffKeys&, const GeoTiffKeys&) = default;
};

enum class CrsKind : std::uint8_t { unknown, projected, geographic, geocentric };

struct Crs {
  std::string name;                 ///< name in the file, e.g. "NAD83 / UTM zone 10N"; may be empty
  CrsKind kind = CrsKind::unknown;  ///< unit of the horizontal system: metres or feet, or degrees
  int epsg = 0;                     ///< EPSG code of the horizontal system; 0: not stated
  int vertical_epsg = 0;            ///< EPSG code of the heights; 0: not stated
  std::string wkt;                  ///< on one line; empty if the file has only GeoTIFF keys
  GeoTiffKeys geotiff;              ///< empty if the file has WKT only
};

/// A statement about the coordinate reference system of points. It changes no coordinate.
struct StatedCrs {
  std::optional<Crs> crs = {};  ///< absent: outputs state no system
  bool replaces = false;        ///< inputs with another system are accepted, and their system is ignored
};

/// Returns the system that `text` names: "EPSG:2154", "EPSG:2154+5720" (with heights), WKT, or a file of WKT such as a
/// .prj; none for "none". A code becomes GeoTIFF keys, since the library has no registry with the WKT of codes. Throws
/// UsageError, beginning with `where`, for anything else and for codes that GeoTIFF keys cannot state.
POINTSWEEP_EXPORT std::optional<Crs> parse_crs(const std::string& text, std::string_view where = "--crs");

/// Parses `wkt`, in one line or several. The result of a text that is not WKT has neither name nor kind nor codes.
POINTSWEEP_EXPORT Crs crs_of_wkt(std::string_view wkt);

/// Returns "EPSG:26910 (NAD83 / UTM zone 10N)", or the known part of it, in at most about 80 characters.
POINTSWEEP_EXPORT std::string short_text(const Crs& crs);

}  // namespace pointsweep
