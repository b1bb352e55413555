// SPDX-License-Identifier: MIT
/// The text that `pointsweep --version` prints.
#pragma once

#include <string>

namespace pointsweep {

/// Lines without a final line end: version, commit (where the build knows it), compiler and build type, instruction
/// set, formats.
std::string version_text();

/// "0.1.0"
std::string version_number();

}  // namespace pointsweep
