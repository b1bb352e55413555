// SPDX-License-Identifier: MIT
/// Which known names a misspelt word may stand for.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pointsweep {

/// Letters to insert, delete or replace to turn one word into the other (Levenshtein).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// "'normals', 'knn' or 'splats'": at most three of `known`, nearest to `word` first. Known must not be empty.
std::string nearest_names(std::string_view word, const std::vector<std::string>& known);

/// The name that `word` is probably a misspelling or the beginning of: at most one letter in three differs, or `word`
/// has at least three letters and the name begins with them. Case does not count. None if no name is that near.
std::optional<std::string> probable_name(std::string_view word, const std::vector<std::string>& known);

}  // namespace pointsweep
