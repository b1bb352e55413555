// SPDX-License-Identifier: MIT
/// The tool `pointsweep`. Exit status 0: done; 1: a file or the machine is at fault; 2: the command line is wrong or
/// names no verb; 3: `verify` could not check everything; 128 + number: stopped by the signal with this number.
#pragma once

namespace pointsweep {

/// Implements main(): parses the command line, runs the verb and returns the exit status.
int run_tool(int argc, char** argv);

}  // namespace pointsweep
