// SPDX-License-Identifier: MIT
// The commit of the build. This file contains nothing else, because it is compiled again after every commit.
#include "cli/console/program.h"

namespace pointsweep {

std::string_view commit_of_build() { return POINTSWEEP_COMMIT; }

}  // namespace pointsweep
