// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las_classes.h"

#include <array>

namespace pointsweep {

std::string_view name_of_las_class(std::uint8_t code) {
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
