// SPDX-License-Identifier: MIT
#include "cli/verbs/commands.h"

#include <string>

#include "cli/text/help.h"

namespace pointsweep {
namespace {

/// Refuses options with empty values: an empty file name would mean the current folder, and other options need a value.
void refuse_empty_values(CLI::App& verb) {
  const CLI::Validator not_empty(
      [](std::string& value) {
        return std::string(value.empty() ? "the value is empty; give one, or leave the option out" : "");
      },
      "");
  for (CLI::Option* option : verb.get_options())
    if (option->get_items_expected_max() > 0) option->check(not_empty);
}

}  // namespace

void add_commands(CLI::App& app) {
  add_convert_command(app);
  add_pipeline_commands(app);
  add_thin_command(app);
  add_transform_command(app);
  add_tile_command(app);
  add_split_command(app);
  add_ground_command(app);
  add_neighbors_command(app);
  add_sort_command(app);
  add_run_command(app);
  add_operators_command(app);
  add_verify_command(app);
  add_info_command(app);
  add_generate_command(app);
  add_render_command(app);
  add_completion_command(app);
  add_man_command(app);
  add_help_command(app);
  for (CLI::App* verb : app.get_subcommands({})) {
    verb->group("Verbs");
    verb->get_help_ptr()->group(kOtherGroup);
    refuse_empty_values(*verb);
  }
}

}  // namespace pointsweep
