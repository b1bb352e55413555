// SPDX-License-Identifier: MIT
/// The entries of a folder.
#pragma once

#include <filesystem>
#include <vector>

namespace pointsweep {

/// Files and folders in `folder` ("": the current one, whose entries have no folder in their paths), in no certain
/// order. Throws Error if it cannot be read.
std::vector<std::filesystem::directory_entry> entries_of(const std::filesystem::path& folder);

/// Returns whether the name of the file begins with a dot.
bool is_hidden(const std::filesystem::path& path);

/// A folder that is no link to one: links may lead in circles.
bool is_own_folder(const std::filesystem::directory_entry& entry);

}  // namespace pointsweep
