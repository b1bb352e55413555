// SPDX-License-Identifier: MIT
/// Patterns of the keys of a bucket, as file_pattern.h has them of files: s3://bucket/tiles/*.laz.
#pragma once

#include <filesystem>
#include <vector>

namespace pointsweep {

/// Returns whether the key has one of the characters * ? [. A key that has them as its own cannot be named. In an
/// address of http, ? begins the query and nothing can be listed.
bool is_remote_pattern(const std::filesystem::path& url);

/// The folders before the first name that is a pattern, with a '/' at the end: "s3://bucket/tiles/".
std::filesystem::path fixed_remote_part(const std::filesystem::path& pattern);

/// The objects whose keys match, in the order of the listing. * and ? stand for any characters but '/', ** as a whole
/// name for any number of nested folders.
std::vector<std::filesystem::path> remote_matches_of(const std::filesystem::path& pattern);

}  // namespace pointsweep
