// SPDX-License-Identifier: MIT
/// The commit that the tool was built from.
#pragma once

#include <string_view>

namespace pointsweep {

/// Twelve digits, or what a packager has set; empty where the build does not know.
std::string_view commit_of_build();

}  // namespace pointsweep
