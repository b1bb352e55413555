// SPDX-License-Identifier: MIT
/// The parts of a URL. A URL is used like a path everywhere and carries no secrets (docs/adr/0022).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "pointsweep/url.h"

namespace pointsweep {

/// Returns whether the objects of a URL can be listed and written: true for all schemes but http and https.
bool is_bucket(std::string_view url);

/// Returns the address for requests: the URL with the credentials that known_place() has removed.
std::string address_of(const std::string& url);

/// Returns an http URL without query and fragment, so that it ends in the name of a file. Returns any other path
/// unchanged.
std::filesystem::path without_query(const std::filesystem::path& path);

/// Returns the URL to which a reference in the document with the URL `base` leads.
std::string resolved(const std::string& base, const std::string& reference);

/// Returns the text with each percent sign and two hexadecimal digits, such as "%20", as the byte they stand for.
std::string percent_decoded(std::string_view text);

}  // namespace pointsweep
