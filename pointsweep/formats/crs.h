// SPDX-License-Identifier: MIT
/// Coordinate reference systems as point files state them: well-known text (WKT) or GeoTIFF keys.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pointsweep {

/// The three GeoTIFF tags that LAS stores as VLRs 34735, 34736 and 34737.
struct GeoTiffKeys {
  std::vector<std::uint16_t>
      directory;  ///< version, revision, minor revision, n, then n times key, place, count, value
  std::vector<double> doubles;
  std::string ascii;
  bool empty() const { return directory.size() < 8; }
  friend bool operator==(const GeoTiffKeys&, const GeoTiffKeys&) = default;
};

enum class CrsKind : std::uint8_t { unknown, projected, geographic, geocentric };

struct Crs {
  std::string name;                 ///< as the file calls it, e.g. "NAD83 / UTM zone 10N"; may be empty
  CrsKind kind = CrsKind::unknown;  ///< of the horizontal system: metres or feet, or degrees
  int epsg = 0;                     ///< EPSG code of the horizontal system; 0: not stated
  int vertical_epsg = 0;            ///< EPSG code of the heights; 0: not stated
  std::string wkt;                  ///< in one line; empty if the file has GeoTIFF keys only
  GeoTiffKeys geotiff;              ///< empty if the file has WKT only
};

/// `wkt` in one line or several; a text that is not WKT has neither name nor kind nor codes.
Crs crs_of_wkt(std::string_view wkt);
Crs crs_of_geotiff(GeoTiffKeys keys);

/// "EPSG:26910 (NAD83 / UTM zone 10N)", or as much of it as is known; for sentences, at most about 80 characters.
std::string short_text(const Crs& crs);

enum class CrsAgreement : std::uint8_t { same, different, undecided };

/// Whether two statements mean the same system. Decided by EPSG codes, kinds, equal texts and equal keys; GeoTIFF
/// projections without a code are the same if all their numbers are. Everything else is undecided, also heights that
/// only one of them defines.
CrsAgreement compare(const Crs& a, const Crs& b);

}  // namespace pointsweep
