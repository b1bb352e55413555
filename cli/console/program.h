// SPDX-License-Identifier: MIT
/// The tool itself: its version, and the command line with which it was called.
#pragma once

#include <string>
#include <string_view>

namespace pointsweep {

/// The text that `pointsweep --version` prints, lines without a final line end: version, commit (where the build knows
/// it), compiler and build type, instruction set, formats.
std::string version_text();

/// "0.1.0"
std::string version_number();

/// Returns twelve digits, or the text that a packager has set; empty if the build does not know the commit.
std::string_view commit_of_build();

/// Keeps the command line. Called once, at the start of main().
void keep_command_line(int argc, const char* const* argv);

/// Returns "pointsweep normals 'my scan.ply' out.ply": the command line, quoted for a shell, with the program's name
/// without its folder.
const std::string& command_line();

}  // namespace pointsweep
