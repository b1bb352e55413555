// SPDX-License-Identifier: MIT
/// Which names somebody may have meant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pointsweep {

/// Letters to insert, delete or replace to turn one word into the other (Levenshtein).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// "'normals', 'knn' or 'splats'": at most three of `known`, nearest to `word` first. Known must not be empty.
std::string nearest_names(std::string_view word, const std::vector<std::string>& known);

}  // namespace pointsweep
