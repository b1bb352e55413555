// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/language/build_chain.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>

#include "pointsweep/cloud.h"
#include "pointsweep/fail.h"
#include "pointsweep/formats/crs.h"
#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/pipeline/plan/kept_fields.h"
#include "pointsweep/points/neighborhood_options.h"

namespace pointsweep {
namespace {

bool is_length(const OptionDeclaration& option) { return option.kind == OptionKind::number && option.unit == "length"; }

/// Returns the default of an option in metres; null if the default is not a length or is 0.
const double* default_length(const OptionDeclaration& option) {
  const auto* metres = std::get_if<double>(&option.preset);
  return is_length(option) && metres != nullptr && *metres != 0 ? metres : nullptr;
}

bool is_made_of_lengths(const Attribute& attribute) {
  return attribute.unit.find("length") != attribute.unit.npos && attribute.kind != Kind::position;
}

/// Returns the declared options of the stage; none if its operator is not declared.
std::vector<OptionDeclaration> declared_options(const ChainStage& stage) {
  const OperatorDeclaration* const declaration = declaration_of(name_of(stage));
  return declaration != nullptr ? declaration->options : std::vector<OptionDeclaration>();
}

/// Returns whether the stage depends on distances: it searches neighbours, has an option that is a length, or makes an
/// attribute that is a length.
bool needs_lengths(const ChainStage& stage) {
  if (operator_of(stage) == nullptr) return false;
  const Contract contract = contract_of(stage);
  if (contract.default_k > 0 || std::ranges::any_of(contract.makes, is_made_of_lengths)) return true;
  return std::ranges::any_of(declared_options(stage), is_length);
}

/// Returns whether the stage may move points. The contract of `set` does not tell before the attributes are known.
bool may_move_points(const ChainStage& stage) {
  if (operator_of(stage) == nullptr) return false;
  const std::vector<Attribute> made = contract_of(stage).makes;
  return name_of(stage) == "set" || std::ranges::find(made, Kind::position, &Attribute::kind) != made.end();
}

double metres_per_unit(const InputCloud& cloud) {
  if (!cloud.crs() || cloud.ignores_crs()) return 1;
  return metres_of_unit(*cloud.crs()).value_or(1);
}

/// Returns the lengths of the stage that have their defaults, such as "cell=3.281 (1 m)", or "cell=1" if the unit is
/// the metre.
std::string default_options(const ChainStage& stage, double metres_per_unit) {
  const Options values = options_of(stage);
  std::string text;
  for (const OptionDeclaration& option : declared_options(stage)) {
    const double* metres = default_length(option);
    if (metres == nullptr) continue;
    const double here = *metres / metres_per_unit;
    if (std::ranges::find(values, Option{option.name, here}) == values.end()) continue;
    text += fmt::format("{}{}={:.4g}", text.empty() ? "" : ", ", option.name, here);
    if (metres_per_unit != 1) text += fmt::format(" ({:g} m)", *metres);
  }
  return text;
}

std::vector<Attribute> made_by(const Chain& chain) {
  std::vector<Attribute> made;
  for (const ChainStage& stage : chain.stages)
    for (const Attribute& a : contract_of(stage).makes) made.push_back(a);
  return made;
}

void note_neighborhood(const ChainStage& stage, Facts& facts) {
  const auto* next = std::get_if<Reneighbor>(&stage);
  if (next != nullptr && next->neighborhood) facts.neighborhood = *next->neighborhood;
}

StageText stage_text(const std::string& name, const Options& options) {
  StageText stage{name, {}, name};
  for (const Option& option : options) stage.options.push_back({option.name, text_of_value(option.value), name});
  return stage;
}

const OptionDeclaration* option_named(const std::vector<OptionDeclaration>& declared, const std::string& name) {
  const auto found = std::ranges::find(declared, name, &OptionDeclaration::name);
  return found == declared.end() ? nullptr : &*found;
}

std::string stage_text(const std::string& name, const Options& options, const std::vector<OptionDeclaration>& declared,
                       Presets presets) {
  StageText stage{name, {}, {}};
  for (const Option& option : options) {
    const OptionDeclaration* declaration = option_named(declared, option.name);
    const bool is_preset = declaration != nullptr && declaration->preset == option.value;
    if (is_preset && presets == Presets::left_out) continue;
    const bool named = declaration == nullptr || !declaration->positional;
    stage.options.push_back({named ? option.name : "", text_of_value(option.value), {}});
  }
  return to_text(std::vector<StageText>{stage});
}

bool may_be_file(const OptionDeclaration& option) {
  return option.kind == OptionKind::file || option.kind == OptionKind::matrix;
}

/// Returns the declaration of an option; null if there is none.
const OptionDeclaration* declared_option(const OperatorDeclaration& op, const OptionText& option) {
  const auto found = std::ranges::find_if(op.options, [&](const OptionDeclaration& declared) {
    return option.name.empty() ? declared.positional : declared.name == option.name;
  });
  return found == op.options.end() ? nullptr : &*found;
}

/// Returns the folder before the first wildcard of a name; the name itself if it has no wildcard.
std::filesystem::path before_wildcards(const std::string& name) {
  const std::size_t wildcard = name.find_first_of("*?[");
  if (wildcard == std::string::npos) return name;
  const std::filesystem::path before(name.substr(0, wildcard));
  return before.has_parent_path() ? before.parent_path() : ".";
}

bool is_there(const std::string& name) {
  std::error_code none;
  return std::filesystem::exists(name, none) ||
         (before_wildcards(name) != name && std::filesystem::exists(before_wildcards(name), none));
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

std::vector<std::string> notes_on_inputs(const InputCloud& cloud, const Chain& chain) {
  std::vector<std::string> sentences;
  const bool drops = std::ranges::any_of(chain.stages, [](const ChainStage& stage) { return drops_rows(stage); });
  if (const auto at = cloud.schema().find("buffer"); at && cloud.readers().size() > 1 && !drops)
    sentences.push_back(
        "the inputs have the attribute 'buffer', as tiles with buffers have: points in a buffer may be in two tiles "
        "and then count twice; the stage where(buffer == 0) leaves the copies out.");
  if (!cloud.crs() || cloud.ignores_crs()) return sentences;
  const std::optional<UnitOfHeights> heights = other_unit_of_heights(*cloud.crs());
  const auto stage = std::ranges::find_if(chain.stages, needs_lengths);
  const bool moves = std::any_of(chain.stages.begin(), stage, may_move_points);
  if (heights && stage != chain.stages.end() && !moves)
    sentences.push_back(
        fmt::format("{}: x and y are in {}, but heights in {}; distances take them for the same unit. "
                    "Convert the heights before, with the stage set(z = z * {}).",
                    name_of(*stage), length_unit_of(*cloud.crs()), heights->name, heights->in_map_units));
  const std::optional<double> stated = metres_of_unit(*cloud.crs());
  if (stated == 1) return sentences;
  for (const ChainStage& each : chain.stages) {
    const std::string options = default_options(each, stated.value_or(1));
    if (options.empty()) continue;
    sentences.push_back(
        stated ? fmt::format("{}: the unit of the cloud is {}, so these defaults are converted: {}.", name_of(each),
                             length_unit_of(*cloud.crs()), options)
               : fmt::format("{}: the input does not state the unit of {}, so it counts as the metre in these "
                             "defaults: "
                             "{}. Give them in feet if it is the foot.",
                             name_of(each), short_text(*cloud.crs()), options));
  }
  return sentences;
}

Chain build_chain(const std::vector<StageText>& stages, Facts facts) {
  const NeighborhoodDeclaration& knn = neighborhood_declaration();
  for (const StageText& stage : stages)
    if (stage.name != knn.name) find_operator(stage);  // an unknown stage is reported before a wrong option
  Chain chain;
  const bool has_knn = !stages.empty() && stages.front().name == knn.name;
  if (has_knn) chain.neighborhood = make_neighborhood(read_options(knn.options, stages.front()));
  append_to(chain, {stages.begin() + (has_knn ? 1 : 0), stages.end()}, std::move(facts));
  return chain;
}

void require_operators(const Chain& chain) {
  if (chain.stages.empty())
    fail_usage(
        "knn alone computes nothing; add an operator, as in knn(k=8) | normals, or leave the pipeline out to copy the "
        "points.");
}

void append_to(Chain& chain, const std::vector<StageText>& stages, Facts facts) {
  facts.neighborhood = chain.neighborhood;
  for (const ChainStage& stage : chain.stages) note_neighborhood(stage, facts);
  for (const StageText& stage : stages) {
    if (stage.name == neighborhood_declaration().name)
      fail_usage("{}: knn comes once and first; for other neighbourhoods from here on write {}.", stage.place,
                 to_text(std::vector<StageText>{{"reneighbor", stage.options, ""}}));
    const OperatorDeclaration& declaration = find_operator(stage);
    const std::vector<OptionDeclaration> options = in_unit(declaration.options, facts.metres_per_unit);
    chain.stages.push_back(declaration.make(read_options(options, stage), facts));
    note_neighborhood(chain.stages.back(), facts);
  }
}

Chain build_chain(const std::vector<StageText>& stages, const InputCloud& cloud, const std::vector<std::string>& keep,
                  const std::string& prefix) {
  return build_chain(stages, facts_of(cloud), keep, prefix);
}

Chain build_chain(const std::vector<StageText>& stages, Facts facts, const std::vector<std::string>& keep,
                  const std::string& prefix) {
  Chain chain = build_chain(stages, std::move(facts));
  chain.keep = without_prefix(keep, prefix, made_by(chain));
  return chain;
}

Chain build_chain(const std::vector<StageText>& stages, const Cloud& cloud, const std::vector<std::string>& keep,
                  const std::string& prefix) {
  return build_chain(stages, cloud.inputs(), keep, prefix);
}

Chain parse_chain(std::string_view pipeline, const Cloud& cloud) {
  return build_chain(parse_pipeline(pipeline), facts_of(cloud.inputs()));
}

void append_stages(Chain& chain, std::string_view pipeline, const Cloud& cloud) {
  append_to(chain, parse_pipeline(pipeline), facts_of(cloud.inputs()));
}

void append_stage(Chain& chain, const std::string& name, const Options& options, const Cloud& cloud) {
  append_to(chain, {stage_text(name, options)}, facts_of(cloud.inputs()));
}

std::string canonical_text(const ChainStage& stage, Presets presets) {
  return stage_text(name_of(stage), options_of(stage), declared_options(stage), presets);
}

std::string canonical_text(const Neighborhood& neighborhood, Presets presets) {
  const NeighborhoodDeclaration& knn = neighborhood_declaration();
  std::string text = stage_text(knn.name, options_of(neighborhood), knn.options, presets);
  if (neighborhood.rule && neighborhood.rule->options().empty()) text += " " + neighborhood.rule->meaning();
  return text;
}

std::vector<std::string> canonical_stages(const Chain& open, Presets presets) {
  const bool is_knn_alone = open.stages.empty();
  const Chain chain = is_knn_alone ? open : with_named_neighborhoods(open);
  std::vector<std::string> stages = {canonical_text(chain.neighborhood, presets)};
  for (const ChainStage& stage : chain.stages) stages.push_back(canonical_text(stage, presets));
  return stages;
}

std::vector<std::string> canonical_stages(const ChainPlan& plan, Presets presets) {
  if (plan.passes.empty()) return {"sort"};
  if (plan.chain.stages.empty()) return {"convert"};
  return canonical_stages(plan.chain, presets);
}

std::string with_absolute_files(std::string_view pipeline) {
  std::vector<StageText> stages = parse_pipeline(pipeline);
  for (StageText& stage : stages) {
    const OperatorDeclaration* const op = declaration_of(stage.name);
    if (op == nullptr) continue;
    for (OptionText& option : stage.options) {
      const OptionDeclaration* const declared = declared_option(*op, option);
      if (declared != nullptr && may_be_file(*declared) && is_there(option.value))
        option.value = std::filesystem::absolute(option.value).lexically_normal().string();
    }
  }
  return to_text(stages);
}

}  // namespace pointsweep
