// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/language/length_units.h"

#include <algorithm>
#include <optional>

#include "pointsweep/fail.h"
#include "pointsweep/formats/crs.h"
#include "pointsweep/operators/kinds/chain_stage.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {
namespace {

bool is_length(const OptionDeclaration& option) { return option.kind == OptionKind::number && option.unit == "length"; }

/// Returns the default of an option in metres; null if the default is no length, or 0 in every unit.
const double* default_length(const OptionDeclaration& option) {
  const auto* metres = std::get_if<double>(&option.preset);
  return is_length(option) && metres != nullptr && *metres != 0 ? metres : nullptr;
}

bool is_made_of_lengths(const Attribute& attribute) {
  return attribute.unit.find("length") != attribute.unit.npos && attribute.kind != Kind::position;
}

/// Returns whether the stage depends on distances: it searches neighbours, has an option that is a length, or makes an
/// attribute that is a length.
bool needs_lengths(const ChainStage& stage) {
  if (operator_of(stage) == nullptr) return false;
  const Contract contract = contract_of(stage);
  if (contract.default_k > 0 || std::ranges::any_of(contract.makes, is_made_of_lengths)) return true;
  const OperatorDeclaration* declaration = declaration_of(name_of(stage));
  return declaration != nullptr && std::ranges::any_of(declaration->options, is_length);
}

double metres_per_unit(const InputCloud& cloud) {
  if (!cloud.crs() || cloud.ignores_crs()) return 1;
  return metres_of_unit(*cloud.crs()).value_or(1);
}

/// Returns the lengths of the stage that have their defaults, such as "cell=3.281 (1 m)", or "cell=1" if the unit is
/// the metre.
std::string default_options(const ChainStage& stage, double metres_per_unit) {
  const OperatorDeclaration* declaration = declaration_of(name_of(stage));
  if (declaration == nullptr) return "";
  const Options values = options_of(stage);
  std::string text;
  for (const OptionDeclaration& option : declaration->options) {
    const double* metres = default_length(option);
    if (metres == nullptr) continue;
    const double here = *metres / metres_per_unit;
    if (std::ranges::find(values, Option{option.name, here}) == values.end()) continue;
    text += fmt::format("{}{}={:.4g}", text.empty() ? "" : ", ", option.name, here);
    if (metres_per_unit != 1) text += fmt::format(" ({:g} m)", *metres);
  }
  return text;
}

}  // namespace

Facts facts_of(const InputCloud& cloud) { return {.points = cloud.count(), .metres_per_unit = metres_per_unit(cloud)}; }

std::vector<OptionDeclaration> in_unit(std::vector<OptionDeclaration> options, double metres_per_unit) {
  for (OptionDeclaration& option : options)
    if (const double* metres = default_length(option)) option.preset = *metres / metres_per_unit;
  return options;
}

void require_lengths(const InputCloud& cloud, const Chain& chain) {
  if (!cloud.crs() || cloud.crs()->kind != CrsKind::geographic || cloud.ignores_crs()) return;
  const auto stage = std::ranges::find_if(chain.stages, needs_lengths);
  if (stage == chain.stages.end()) return;
  fail_usage(
      "The coordinates are degrees of {}, between which '{}' finds no distances: transform the cloud into a projected "
      "system first (e.g. with 'pdal translate IN OUT reprojection'), or add --ignore-crs to take degrees for lengths.",
      short_text(*cloud.crs()), name_of(*stage));
}

std::vector<std::string> notes_on_defaults(const InputCloud& cloud, const Chain& chain) {
  std::vector<std::string> sentences;
  if (!cloud.crs() || cloud.ignores_crs()) return sentences;
  const std::optional<double> stated = metres_of_unit(*cloud.crs());
  if (stated == 1) return sentences;
  for (const ChainStage& stage : chain.stages) {
    const std::string options = default_options(stage, stated.value_or(1));
    if (options.empty()) continue;
    sentences.push_back(
        stated ? fmt::format("{}: the unit of the cloud is {}, so these defaults are converted: {}.", name_of(stage),
                             length_unit_of(*cloud.crs()), options)
               : fmt::format("{}: the input does not state the unit of {}, so it counts as the metre in these "
                             "defaults: "
                             "{}. Give them in feet if it is the foot.",
                             name_of(stage), short_text(*cloud.crs()), options));
  }
  return sentences;
}

}  // namespace pointsweep
