// SPDX-License-Identifier: MIT
/// The tool `pointsweep`. Status 0: done; 1: a file or the machine is at fault; 2: the command line
/// is wrong or names no verb; 3: `verify` could not check everything; 128 + number: stopped by a signal.
#pragma once

namespace pointsweep {

/// main(): parses the command line, runs the verb and gives the status.
int run_tool(int argc, char** argv);

}  // namespace pointsweep
