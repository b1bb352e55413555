// SPDX-License-Identifier: MIT
// The commit of the build, in a file of its own since it changes with every commit.
#include "cli/console/program.h"

namespace pointsweep {

std::string_view commit_of_build() { return POINTSWEEP_COMMIT; }

}  // namespace pointsweep
