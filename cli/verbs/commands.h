// SPDX-License-Identifier: MIT
/// Declares a function for each verb of the tool. To add a verb, define its function in a new source file, declare it
/// here, and call it in add_commands().
#pragma once

#include <CLI/App.hpp>

#include "pointsweep/error.h"

namespace pointsweep {

/// Each function adds its verb to the tool. The verb runs while the command line is parsed, and throws its errors.
void add_convert_command(CLI::App& app);
void add_pipeline_commands(CLI::App& app);  // normals, curvature, splats, features, fair, denoise
void add_thin_command(CLI::App& app);
void add_transform_command(CLI::App& app);
void add_tile_command(CLI::App& app);
void add_split_command(CLI::App& app);
void add_ground_command(CLI::App& app);
void add_neighbors_command(CLI::App& app);
void add_sort_command(CLI::App& app);
void add_run_command(CLI::App& app);
void add_operators_command(CLI::App& app);
void add_verify_command(CLI::App& app);
void add_info_command(CLI::App& app);
void add_generate_command(CLI::App& app);
void add_render_command(CLI::App& app);
void add_completion_command(CLI::App& app);
void add_man_command(CLI::App& app);
void add_help_command(CLI::App& app);

/// Adds all verbs, in the order of the help.
void add_commands(CLI::App& app);

/// Error of `verify` if it found no difference but could not check everything. Its exit status is 3.
class NotChecked : public Error {
 public:
  using Error::Error;
};

}  // namespace pointsweep
