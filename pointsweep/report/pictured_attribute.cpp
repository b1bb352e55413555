// SPDX-License-Identifier: MIT
/// The choice of the attribute that the picture of a run shows.
#include <algorithm>
#include <array>
#include <ranges>
#include <set>
#include <string_view>

#include "pointsweep/points/schema.h"
#include "pointsweep/program/pipeline.h"
#include "pointsweep/program/report.h"

namespace pointsweep {
namespace {

constexpr std::array<const char*, 6> kCurvatures = {
    "rms_curvature", "mean_curvature", "absolute_curvature", "k1", "surface_variation", "gaussian_curvature"};
/// Operators whose results are positions and lists, so that they give no quantity of a point to show.
constexpr std::array<std::string_view, 4> kNotPictured = {"neighbors", "fair", "reneighbor", "resort"};
/// Beginnings of the names of fields that are parts of vectors or of lists.
constexpr std::array<std::string_view, 6> kParts = {"splat_",     "k1_",       "normal_eigenvalue",
                                                    "neighbor_0", "distance_", "normal"};

bool is_part(std::string_view name) {
  return name == "nx" || name == "ny" || name == "nz" ||
         std::ranges::any_of(kParts, [&](std::string_view part) { return name.starts_with(part); });
}

/// Returns the colouring that shows the results of the operator `op`; empty if it has none to show. `made`: the fields
/// of the output that operators have made.
std::string shown_by(std::string_view op, const std::vector<std::string>& made, const Schema& output) {
  if (op == "normals" || op == "splats") return output.find("nx") ? "plain" : "";
  if (op == "curvature") {
    for (const char* name : kCurvatures)
      if (output.find(name)) return name;
    return {};
  }
  if (std::ranges::find(kNotPictured, op) != kNotPictured.end()) return {};
  for (const std::string& name : made)
    if (output.fields[*output.find(name)].count == 1 && !is_part(name)) return name;
  return {};
}

}  // namespace

std::vector<std::string> made_numbers(std::span<const std::string> operators, const Schema& input,
                                      const Schema& output) {
  std::set<std::string> again;
  for (const std::string& op : operators)
    if (const OperatorDeclaration* declaration = declaration_of(op))
      for (const Attribute& a : contract_of(*declaration).makes) again.insert(a.fields.begin(), a.fields.end());
  std::vector<std::string> made;
  for (const Field& field : output.fields)
    if (!input.find(field.name) || again.contains(library_name_of(field.name))) made.push_back(field.name);
  return made;
}

std::string pictured_attribute(std::span<const std::string> operators, const Schema& input, const Schema& output) {
  const std::vector<std::string> made = made_numbers(operators, input, output);
  for (const std::string& op : operators | std::views::reverse) {
    const std::string shown = shown_by(op, made, output);
    if (!shown.empty()) return shown;
  }
  return {};
}

}  // namespace pointsweep
