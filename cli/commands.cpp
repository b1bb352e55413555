// SPDX-License-Identifier: MIT
#include "cli/commands.h"

namespace pointsweep {

void add_commands(CLI::App& app) {
  add_pipeline_commands(app);
  add_thin_command(app);
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
  for (CLI::App* verb : app.get_subcommands({})) verb->group("Verbs");
}

}  // namespace pointsweep
