// SPDX-License-Identifier: MIT
/// Manual pages in roff, from the declarations of the verbs.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <string_view>

namespace pointsweep {

/// pointsweep(1): what the tool is, its verbs, its exit status.
std::string man_page_of_tool(const CLI::App& app);
/// pointsweep-VERB(1). Empty if there is no such verb.
std::string man_page_of_verb(const CLI::App& app, std::string_view verb);

}  // namespace pointsweep
