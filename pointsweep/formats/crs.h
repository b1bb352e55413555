// SPDX-License-Identifier: MIT
/// Coordinate reference systems: well-known text, GeoTIFF keys, units, and whether two statements mean the same system.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/crs.h"

namespace pointsweep {

/// A node `KEYWORD["value", 12, CHILD[...]]` of WKT, which may also have round brackets.
struct WktNode {
  std::string keyword;              ///< in upper case
  std::vector<std::string> values;  ///< quoted texts and numbers in their order
  std::vector<WktNode> children;
};

/// Parses WKT. Two nodes with a comma between them, as Esri writes them, become the children of a COMPD_CS. Returns
/// nothing for a text that is not WKT or has nodes more than 64 levels below the root.
std::optional<WktNode> parse_wkt(std::string_view text);

/// Returns the text up to its first NUL. Each run of white space outside of quotes becomes one space; white space at
/// both ends is removed. Inside quotes, each white character becomes a space.
std::string wkt_in_one_line(std::string_view text);

Crs crs_of_geotiff(GeoTiffKeys keys);

/// Returns the kind of the horizontal system with this EPSG code; `unknown` for compound, vertical and geocentric
/// systems and for codes outside of 2000 to 32766. Codes that the registry lacks may have any kind.
CrsKind kind_of_epsg(int code);

/// Returns GeoTIFF keys that state the projected or geographic system with the code `epsg`, and the system of heights
/// with the code `vertical_epsg`, if this is not 0.
GeoTiffKeys geotiff_of_epsg(int epsg, int vertical_epsg);

/// Returns the coordinate reference system that the WKT and the GeoTIFF keys of a file state; either may be empty. If
/// both are stated, `wkt_counts` decides which of them is interpreted, and the result holds both. Returns none if both
/// are empty.
std::optional<Crs> crs_of_both(const std::string& wkt, GeoTiffKeys keys, bool wkt_counts);

enum class CrsAgreement : std::uint8_t { same, different, undecided };

/// Compares two statements of a system by EPSG codes, kinds, equal texts and equal keys. If both have GeoTIFF keys and
/// one has no code, they are the same if the numbers of all keys are equal, and different if both state a key with
/// different numbers. All other cases are undecided, including equal codes of which only one has a code of heights.
CrsAgreement compare(const Crs& a, const Crs& b);

struct UnitOfHeights {
  std::string name;     ///< such as "US survey ft"
  double in_map_units;  ///< length of the unit in the unit of x and y
};
/// Returns the unit of heights if `crs` states it, and another unit for x and y whose length differs by more than a
/// hundred-thousandth.
std::optional<UnitOfHeights> other_unit_of_heights(const Crs& crs);

/// Returns the length in metres of the length unit of `crs`; nothing for geographic systems and for units other than
/// the metre, the foot and the US survey foot.
std::optional<double> metres_of_unit(const Crs& crs);

}  // namespace pointsweep
