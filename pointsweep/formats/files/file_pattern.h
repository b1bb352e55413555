// SPDX-License-Identifier: MIT
/// Patterns with the wildcards of a shell: of file names, `tiles/*.laz`, `**/ground_[0-9]?.las`, and of the keys of a
/// bucket, `s3://bucket/tiles/*.laz`.
#pragma once

#include <filesystem>
#include <vector>

namespace pointsweep {

/// Returns whether the path has one of the characters * ? [ and no file or folder has exactly this path.
bool is_file_pattern(const std::filesystem::path& path);

/// Returns the files that the pattern matches, or the folders if it ends in '/', each once and in no particular order.
/// * stands for any number of characters other than '/', ? for one, [a-z] for one of these characters, and a name **
/// for any number of nested folders. A name that begins with a dot matches only a name of the pattern that begins with
/// a dot. A file or folder whose name equals a name of the pattern, as "scan [2]" in "scan [2]/*.laz", is the only
/// match of that name. Symbolic links are followed, except by **. Throws Error for a folder that cannot be read.
std::vector<std::filesystem::path> matches_of(const std::filesystem::path& pattern);

/// Returns the folders before the first name with a wildcard, not counting names that exist literally: "tiles" for
/// "tiles/*/a.laz", "" if there are none.
std::filesystem::path fixed_part(const std::filesystem::path& pattern);

/// Returns whether the key in a bucket has one of the characters * ? [, which are always wildcards, even if an object
/// has exactly this key. In an address of http only * is a wildcard, since ? begins the query.
bool is_remote_pattern(const std::filesystem::path& url);

/// Returns the folders before the first name with a wildcard, with a '/' at the end: "s3://bucket/tiles/".
std::filesystem::path fixed_remote_part(const std::filesystem::path& pattern);

/// Returns the objects whose keys the pattern matches, in the order of the listing. Wildcards and names with a dot are
/// as in matches_of(), but no name is taken literally.
std::vector<std::filesystem::path> remote_matches_of(const std::filesystem::path& pattern);

}  // namespace pointsweep
