// SPDX-License-Identifier: MIT
/// URLs in place of paths: inputs from https://, s3://, gs:// and az://, outputs to the last three (docs/urls.md).
///
/// Every function that takes the path of an input or an output takes a URL, too, if the build has POINTSWEEP_REMOTE.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "pointsweep/export.h"

namespace pointsweep {

/// Returns whether this build can read and write URLs (POINTSWEEP_REMOTE).
POINTSWEEP_EXPORT bool reads_urls();

/// Returns whether a name begins with a scheme and "://".
POINTSWEEP_EXPORT bool is_url(std::string_view name);
POINTSWEEP_EXPORT bool is_url(const std::string& name);
POINTSWEEP_EXPORT bool is_url(const std::filesystem::path& name);

/// Returns the place that a user has named: a path for file://, a URL without its password and signature, or the
/// unchanged name. The process remembers passwords and signatures for requests. Cloud and list_inputs() call this
/// function; a program that prints names calls it first.
POINTSWEEP_EXPORT std::filesystem::path known_place(const std::filesystem::path& named);
/// Returns a text, such as a pipeline, in which known_place() has replaced each URL.
POINTSWEEP_EXPORT std::string with_known_places(const std::string& text);

}  // namespace pointsweep
