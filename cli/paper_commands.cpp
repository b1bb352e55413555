// SPDX-License-Identifier: MIT
/// `pointsweep curvature|splats|fair IN... OUT`: the pipelines of the paper (its Section 4.3) by one word each.
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/pipeline_run.h"
#include "cli/stage_options.h"
#include "pointsweep/error.h"

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
    {"curvature", "Compute normals and curvatures", "normals | curvature", "", "8", "-k 64 --keep k1,k2"},
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
  stages.insert(stages.begin(), neighborhood_stage(command.neighborhood, form.neighbors, form.verb));
  return stages;
}

void add_short_form(CLI::App& app, const ShortForm& form) {
  CLI::App& verb = *app.add_subcommand(form.verb, form.meaning);
  auto command = std::make_shared<ShortFormCommand>();
  add_inputs_and_output(verb, command->run.paths, "the file to write: all attributes of the input, and what is made");
  add_output_option(verb, command->run.paths.named_output);
  add_neighborhood_options(verb, form.neighbors, command->neighborhood);
  for (const OperatorDeclaration& declaration : all_operators())
    if (declaration.name == form.with_options) add_stage_options(verb, declaration.options, command->options);
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
