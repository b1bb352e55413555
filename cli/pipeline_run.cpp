// SPDX-License-Identifier: MIT
#include "cli/pipeline_run.h"

#include <algorithm>

#include "pointsweep/error.h"
#include "pointsweep/pipeline/build_chain.h"
#include "pointsweep/pipeline/preview.h"

namespace pointsweep {
namespace {

std::vector<std::string> parse_names(const std::string& text) {
  std::vector<std::string> names(1);
  for (const char c : text) c == ',' ? void(names.emplace_back()) : names.back().push_back(c);
  for (const std::string& name : names)
    if (name.empty()) fail_usage("--keep: '{}' is not a list of attributes such as normal,splat_length.", text);
  return names;
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

void add_keep_option(CLI::App& verb, std::vector<std::string>& keep, const char* meaning) {
  verb.add_option_function<std::string>(
          "--keep", [&keep](const std::string& text) { keep = parse_names(text); }, meaning)
      ->type_name("A,B,...");
}

void add_pipeline_options(CLI::App& verb, PipelineRun& run) {
  add_keep_option(verb, run.keep, "Made attributes to write, e.g. normal (default: all)");
  verb.add_flag("--dry-run", run.dry, "Say what would be done and how much memory it takes; write nothing");
  add_order_option(verb, run.common);
  add_engine_option(verb, run.common);
  add_positions_option(verb, run.common);
  add_run_options(verb, run.common);
}

void run_stages(const std::vector<StageText>& stages, const PipelineRun& command) {
  if (command.dry) {
    look_at_cloud(command.paths, command.common, [&](Cloud& cloud, const RunOptions& options) {
      const Chain chain = build_chain(stages, cloud, command.keep);
      require_a_mover(chain, command.common);
      fmt::print("{}", to_text(preview(cloud, chain, options, command.paths.output())));
    });
    return;
  }
  run_over_cloud(command.paths, command.common, [&](Cloud& cloud, RunOptions options) {
    const Chain chain = build_chain(stages, cloud, command.keep);
    require_a_mover(chain, command.common);
    options.resume_key = to_text(stages);
    return run(cloud, chain, {.points = command.paths.output(), .arrays = {}, .writer = {}}, options);
  });
}

}  // namespace pointsweep
