// SPDX-License-Identifier: MIT
/// The tool itself: its version, and the command line with which it was called.
#pragma once

#include <string>
#include <string_view>

namespace pointsweep {

/// Returns the text of `pointsweep --version`, lines without a final line end: version, commit (if the build knows it),
/// compiler and build type, instruction set, formats, codecs, schemes of URLs.
std::string version_text();

/// Returns the version of the tool, e.g. "0.1.0".
std::string version_number();

/// Returns the first twelve digits of the commit, or the text that a packager has set; empty if the build does not know
/// the commit.
std::string_view commit_of_build();

/// Stores the command line for command_line(). Must be called once, at the start of main().
void keep_command_line(int argc, const char* const* argv);

/// Returns the command line, quoted for a shell, with "pointsweep" in place of the path of the program: "pointsweep
/// normals 'my scan.ply' out.ply".
const std::string& command_line();

}  // namespace pointsweep
