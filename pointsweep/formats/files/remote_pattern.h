// SPDX-License-Identifier: MIT
/// Patterns of the keys of a bucket, s3://bucket/tiles/*.laz, like the patterns of files in file_pattern.h.
#pragma once

#include <filesystem>
#include <vector>

namespace pointsweep {

/// Returns whether the key has one of the characters * ? [, all of which are wildcards: no pattern names a key that
/// contains them. In an address of http only * counts, since ? begins the query.
bool is_remote_pattern(const std::filesystem::path& url);

/// Returns the folders before the first name with a wildcard, with a '/' at the end: "s3://bucket/tiles/".
std::filesystem::path fixed_remote_part(const std::filesystem::path& pattern);

/// Returns the objects whose keys match, in the order of the listing. * and ? stand for any characters but '/', and a
/// name ** for any number of nested folders.
std::vector<std::filesystem::path> remote_matches_of(const std::filesystem::path& pattern);

}  // namespace pointsweep
