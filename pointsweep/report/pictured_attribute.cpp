// SPDX-License-Identifier: MIT
#include "pointsweep/report/pictured_attribute.h"

#include <algorithm>
#include <array>
#include <ranges>
#include <string_view>

namespace pointsweep {
namespace {

constexpr std::array<const char*, 6> kCurvatures = {
    "rms_curvature", "mean_curvature", "absolute_curvature", "k1", "surface_variation", "gaussian_curvature"};
/// Operators whose results are places and lists, not quantities of a point.
constexpr std::array<std::string_view, 4> kNotPictured = {"neighbors", "fair", "reneighbor", "resort"};
/// Beginnings of names that are parts of vectors or of lists.
constexpr std::array<std::string_view, 6> kParts = {"splat_",     "k1_",       "normal_eigenvalue",
                                                    "neighbor_0", "distance_", "normal"};

bool is_part(std::string_view name) {
  return name == "nx" || name == "ny" || name == "nz" ||
         std::any_of(kParts.begin(), kParts.end(), [&](std::string_view part) { return name.starts_with(part); });
}

std::string shown_by(std::string_view op, const Schema& input, const Schema& output) {
  if (op == "normals" || op == "splats") return output.find("nx") ? "plain" : "";
  if (op == "curvature") {
    for (const char* name : kCurvatures)
      if (output.find(name)) return name;
    return {};
  }
  if (std::find(kNotPictured.begin(), kNotPictured.end(), op) != kNotPictured.end()) return {};
  for (const Field& field : output.fields)
    if (field.count == 1 && !is_part(field.name) && !input.find(field.name)) return field.name;
  return {};
}

}  // namespace

std::string pictured_attribute(std::span<const std::string> operators, const Schema& input, const Schema& output) {
  for (const std::string& op : operators | std::views::reverse) {
    const std::string shown = shown_by(op, input, output);
    if (!shown.empty()) return shown;
  }
  return {};
}

}  // namespace pointsweep
