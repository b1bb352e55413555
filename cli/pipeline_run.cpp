// SPDX-License-Identifier: MIT
#include "cli/pipeline_run.h"

#include <algorithm>

#include "cli/quantities.h"
#include "pointsweep/error.h"
#include "pointsweep/pipeline/build_chain.h"
#include "pointsweep/pipeline/preview.h"

namespace pointsweep {
namespace {

/// "none", "up", "input" or "viewpoint X,Y,Z" as options of the operator `normals`.
std::vector<OptionText> parse_orientation(const std::string& text) {
  const std::string place = "--orient", viewpoint = "viewpoint ";
  if (text.starts_with(viewpoint)) {
    const std::string point = text.substr(viewpoint.size());
    parse_vector("--orient viewpoint", point);
    return {{"orient", "viewpoint", place}, {"viewpoint", point, place}};
  }
  if (text != "none" && text != "up" && text != "input")
    fail_usage("--orient: '{}' is not none, up, viewpoint X,Y,Z or input.", text);
  return {{"orient", text, place}};
}

bool says_orient(const StageText& stage) {
  return std::ranges::find(stage.options, "orient", &OptionText::name) != stage.options.end();
}

void add_orient_option(CLI::App& verb, PipelineRun& run) {
  verb.add_option_function<std::string>(
          "--orient", [&run](const std::string& text) { run.orientation = parse_orientation(text); },
          "How to orient normals: none, up, viewpoint X,Y,Z (towards that point), or input (to the side of the normals "
          "that the input has) (default: none)")
      ->type_name("HOW");
}

/// An option that would change nothing is refused.
void require_a_mover(const Chain& chain, const CommonOptions& options) {
  const auto moves = [](const auto& op) {
    const Contract contract = op->contract();
    return std::any_of(contract.makes.begin(), contract.makes.end(),
                       [](const Attribute& a) { return a.name == position_attribute().name; });
  };
  if (options.moved_positions && std::none_of(chain.operators.begin(), chain.operators.end(), moves))
    fail_usage("--positions: no stage moves points, so positions keep the type of the input; leave the option out.");
}

}  // namespace

void add_pipeline_options(CLI::App& verb, PipelineRun& run) {
  add_orient_option(verb, run);
  add_keep_option(verb, run.common.keep, kKeepMeaning);
  add_order_option(verb, run.common);
  add_engine_option(verb, run.common);
  add_positions_option(verb, run.common);
  add_naming_options(verb, run.common);
  add_provenance_options(verb, run.common);
  add_run_options(verb, run.common);
}

void orient_normals(std::vector<StageText>& stages, const std::vector<OptionText>& orientation) {
  if (orientation.empty()) return;
  bool any = false;
  for (StageText& stage : stages) {
    if (stage.name != "normals") continue;
    if (says_orient(stage))
      fail_usage("{}: normals has an orientation in the pipeline; leave out --orient or that one.", stage.place);
    stage.options.insert(stage.options.end(), orientation.begin(), orientation.end());
    any = true;
  }
  if (!any) fail_usage("--orient: the pipeline makes no normals; add the stage normals, or leave out --orient.");
}

void run_stages(std::vector<StageText> stages, const PipelineRun& command) {
  orient_normals(stages, command.orientation);
  build_chain(stages, Facts{});  // wrong names and options are refused before files are opened
  if (command.common.dry_run) {
    look_at_cloud(command.paths, command.common, [&](Cloud& cloud, const RunOptions& options) {
      const Chain chain = build_chain(stages, cloud, command.common.keep);
      require_a_mover(chain, command.common);
      fmt::print("{}", to_text(preview(cloud, chain, options, command.paths.output())));
    });
    return;
  }
  run_over_cloud(command.paths, command.common, [&](Cloud& cloud, const RunOptions& options) {
    const Chain chain = build_chain(stages, cloud, command.common.keep);
    require_a_mover(chain, command.common);
    return run(cloud, chain, {.points = command.paths.output(), .arrays = {}, .writer = {}}, options);
  });
}

}  // namespace pointsweep
