// SPDX-License-Identifier: MIT
#include "pointsweep/render/attribute_unit.h"

#include <algorithm>
#include <array>

namespace pointsweep {
namespace {

template <std::size_t N>
bool is_one_of(const std::array<std::string_view, N>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

std::string unit_of_attribute(std::string_view name, std::string_view length) {
  constexpr std::array<std::string_view, 7> kLengths = {"height",          "x",     "y", "z", "splat_length",
                                                        "neighbor_radius", "radius"};
  constexpr std::array<std::string_view, 5> kCurvatures = {"k1", "k2", "mean_curvature", "rms_curvature",
                                                           "absolute_curvature"};
  if (is_one_of(kLengths, name) || name.starts_with("distance_"))
    return length.empty() ? "file units" : std::string(length);
  const std::string unit(length.empty() ? "file unit" : length);
  if (is_one_of(kCurvatures, name)) return "1/" + unit;
  if (name == "gaussian_curvature") return "1/" + unit + "^2";
  if (name == "gps_time") return "s";
  if (name == "scan_angle") return "degrees";
  return {};
}

}  // namespace pointsweep
