// SPDX-License-Identifier: MIT
#include "cli/commands.h"

namespace pointsweep {

void add_commands(CLI::App& app) {
  add_info_command(app);
  add_generate_command(app);
}

}  // namespace pointsweep
