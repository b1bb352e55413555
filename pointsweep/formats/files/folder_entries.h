// SPDX-License-Identifier: MIT
/// The entries of a folder.
#pragma once

#include <filesystem>
#include <vector>

namespace pointsweep {

/// Returns the files and folders in `folder`, in no certain order. "" is the current folder; paths of its entries have
/// no folder. Throws Error if the folder cannot be read.
std::vector<std::filesystem::directory_entry> entries_of(const std::filesystem::path& folder);

/// Returns whether the name of the file begins with a dot.
bool is_hidden(const std::filesystem::path& path);

/// Returns whether the entry is a folder and no symbolic link. Links may lead in circles.
bool is_own_folder(const std::filesystem::directory_entry& entry);

}  // namespace pointsweep
