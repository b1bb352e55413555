// SPDX-License-Identifier: MIT
/// A search for the known names that a misspelt word may mean.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/export.h"

namespace pointsweep {

/// Returns the number of insertions, deletions and replacements of letters that turn one word into the other
/// (Levenshtein distance).
POINTSWEEP_EXPORT std::size_t edit_distance(std::string_view a, std::string_view b);

/// Returns a text like "'normals', 'knn' or 'splats'" with at most three names of `known`, the most similar to `word`
/// first. `known` must not be empty.
POINTSWEEP_EXPORT std::string nearest_names(std::string_view word, const std::vector<std::string>& known);

/// Returns the known name of which `word` is probably a misspelling, with at most one different letter in three
/// (rounded up), or of which `word` is the beginning, with at least three letters. Case does not count. Returns nullopt
/// if no name is so similar.
POINTSWEEP_EXPORT std::optional<std::string> probable_name(std::string_view word,
                                                           const std::vector<std::string>& known);

}  // namespace pointsweep
