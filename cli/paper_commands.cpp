// SPDX-License-Identifier: MIT
/// `pointsweep curvature|splats|fair IN... OUT`: the pipelines of the paper (its Section 4.3) by one word each.
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/pipeline_run.h"
#include "pointsweep/error.h"
#include "pointsweep/pipeline/registry.h"

namespace pointsweep {
namespace {

struct ShortForm {
  const char* verb;
  const char* meaning;
  const char* stages;        ///< after knn
  const char* with_options;  ///< the stage whose options are those of the verb; empty: none
  const char* neighbors;     ///< k where neither k nor a radius is given
  const char* example;
};

constexpr ShortForm kShortForms[] = {
    {"curvature", "Compute normals and curvatures", "normals | curvature", "", "8", "-k 24 --keep k1,k2"},
    {"splats", "Compute normals and ellipses that cover the surface", "normals | splats", "", "8", "-k 12"},
    {"fair", "Smooth the points, sparing edges; normals and splats of the moved ones",
     "normals | splats | fair | normals | splats", "fair", "64", "-k 96 --f 0.3"},
};

struct ShortFormCommand {
  PipelineRun run;
  std::vector<OptionText> neighborhood, options;
};

std::vector<StageText> stages_of(const ShortForm& form, const ShortFormCommand& command) {
  std::vector<StageText> stages = parse_pipeline(form.stages, form.verb);
  for (StageText& stage : stages)
    if (stage.name == form.with_options) stage.options = command.options;
  StageText knn{neighborhood_declaration().name, command.neighborhood, form.verb};
  if (knn.options.empty()) knn.options.push_back({"k", form.neighbors, form.verb});
  stages.insert(stages.begin(), knn);
  return stages;
}

void add_option(CLI::App& verb, const std::string& flag, const OptionDeclaration& option, const std::string& preset,
                std::vector<OptionText>& into) {
  const std::string help =
      fmt::format("{}: {}{}", option.allowed(), option.meaning, preset.empty() ? "" : " (default: " + preset + ")");
  verb.add_option_function<std::string>(
          flag,
          [&into, flag, name = option.name](const std::string& value) {
            into.push_back({name, value, flag});
          },
          help)
      ->type_name("VALUE");
}

void add_short_form(CLI::App& app, const ShortForm& form) {
  CLI::App& verb = *app.add_subcommand(form.verb, form.meaning);
  auto command = std::make_shared<ShortFormCommand>();
  add_inputs_and_output(verb, command->run.paths, "the file to write: all attributes of the input, and what is made");
  for (const OptionDeclaration& option : neighborhood_declaration().options) {
    const bool k = option.name == "k";
    add_option(verb, (k ? "-" : "--") + option.name, option, k ? form.neighbors : "", command->neighborhood);
  }
  for (const OperatorDeclaration& declaration : all_operators()) {
    if (declaration.name != form.with_options) continue;
    for (const OptionDeclaration& option : declaration.options)
      add_option(verb, "--" + option.name, option, option.preset, command->options);
  }
  add_pipeline_options(verb, command->run);
  verb.footer(
      fmt::format("Short for 'run' with the pipeline knn(k={}) | {}\n\nExample:\n"
                  "  pointsweep {} scan.ply out.ply {}",
                  form.neighbors, form.stages, form.verb, form.example));
  verb.callback([&form, command] { run_stages(stages_of(form, *command), command->run); });
}

}  // namespace

void add_paper_commands(CLI::App& app) {
  for (const ShortForm& form : kShortForms) add_short_form(app, form);
}

}  // namespace pointsweep
