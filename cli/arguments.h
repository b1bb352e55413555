// SPDX-License-Identifier: MIT
/// The command line as the parser wants it.
#pragma once

#include <string>
#include <vector>

namespace pointsweep {

/// The words after the name of the tool, last first. `--orient viewpoint X,Y,Z` becomes one option with one value
/// "viewpoint X,Y,Z": to the parser its last word would look like a file.
std::vector<std::string> arguments_for_parser(int argc, const char* const* argv);

}  // namespace pointsweep
