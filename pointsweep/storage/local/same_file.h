// SPDX-License-Identifier: MIT
/// Checks that the files that a run reads and writes are different files, by any paths.
#pragma once

#include <filesystem>
#include <vector>

namespace pointsweep {

/// Throws UsageError if a file of `written` is one of `read` or is written twice: the same device and inode (symbolic
/// links, hard links, /proc/self/fd), or the same canonical path (also of files that do not exist yet). Empty paths are
/// ignored.
void require_separate_files(const std::vector<std::filesystem::path>& read,
                            const std::vector<std::filesystem::path>& written);

}  // namespace pointsweep
