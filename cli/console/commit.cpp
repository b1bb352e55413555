// SPDX-License-Identifier: MIT
// Compiled alone, since it changes with every commit.
#include "cli/console/program.h"

namespace pointsweep {

std::string_view commit_of_build() { return POINTSWEEP_COMMIT; }

}  // namespace pointsweep
