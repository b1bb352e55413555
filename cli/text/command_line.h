// SPDX-License-Identifier: MIT
/// The command line with which the tool was called.
#pragma once

#include <string>

namespace pointsweep {

/// Keeps the command line and the version, e.g. "0.1.0". Called once, at the start of main().
void keep_command_line(int argc, const char* const* argv, std::string version);

/// "pointsweep normals 'my scan.ply' out.ply": as a shell would take it; the program's name without its folder.
const std::string& command_line();
/// Returns the version of the program that was given to keep_command_line().
const std::string& kept_version();

}  // namespace pointsweep
