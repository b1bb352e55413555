// SPDX-License-Identifier: MIT
/// The standard classes of LAS 1.4 (ASPRS, revision 15, Table 17).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace pointsweep {

/// Returns "Ground", "High vegetation", ...; "Reserved" for 8, 12 and 23 to 63, "User definable" for 64 to 255.
inline std::string_view name_of_las_class(std::uint8_t code) {
  constexpr std::array<std::string_view, 23> kNames = {"Never classified",
                                                       "Unclassified",
                                                       "Ground",
                                                       "Low vegetation",
                                                       "Medium vegetation",
                                                       "High vegetation",
                                                       "Building",
                                                       "Low point (noise)",
                                                       "Reserved",
                                                       "Water",
                                                       "Rail",
                                                       "Road surface",
                                                       "Reserved",
                                                       "Wire (guard)",
                                                       "Wire (conductor)",
                                                       "Transmission tower",
                                                       "Wire connector",
                                                       "Bridge deck",
                                                       "High noise",
                                                       "Overhead structure",
                                                       "Ignored ground",
                                                       "Snow",
                                                       "Temporal exclusion"};
  if (code < kNames.size()) return kNames[code];
  return code < 64 ? "Reserved" : "User definable";
}

}  // namespace pointsweep
