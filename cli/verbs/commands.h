// SPDX-License-Identifier: MIT
/// The verbs of the tool. To add a verb, define its function in a new source file, declare it here, and give it a row
/// in the table of commands.cpp.
#pragma once

#include <CLI/App.hpp>
#include <string_view>

#include "pointsweep/error.h"

namespace pointsweep {

/// Each function adds the options of a verb and the callback that runs it. The callback runs while the command line is
/// parsed, and throws the errors of the verb.
void declare_convert_verb(CLI::App& verb);
void declare_short_form(CLI::App& verb);  // normals, curvature, splats, features, fair, denoise
void declare_thin_verb(CLI::App& verb);
void declare_transform_verb(CLI::App& verb);
void declare_tile_verb(CLI::App& verb);
void declare_split_verb(CLI::App& verb);
void declare_ground_verb(CLI::App& verb);
void declare_neighbors_verb(CLI::App& verb);
void declare_sort_verb(CLI::App& verb);
void declare_run_verb(CLI::App& verb);
void declare_operators_verb(CLI::App& verb);
void declare_verify_verb(CLI::App& verb);
void declare_info_verb(CLI::App& verb);
void declare_generate_verb(CLI::App& verb);
void declare_render_verb(CLI::App& verb);
void declare_completion_verb(CLI::App& verb);
void declare_man_verb(CLI::App& verb);
void declare_help_verb(CLI::App& verb);

/// Adds all verbs, in the order of the help. `asked`: first argument of the command line. If it is a verb, only that
/// verb gets its options, because the tool starts a third sooner without the options of the others. All verbs get their
/// options for help, completion and man, which show other verbs, and if `asked` is no verb.
void add_verbs(CLI::App& app, std::string_view asked = "");

/// Error of `verify` if it found no difference but could not check everything. Its exit status is 3.
class NotChecked : public Error {
 public:
  using Error::Error;
};

}  // namespace pointsweep
