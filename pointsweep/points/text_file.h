// SPDX-License-Identifier: MIT
/// Small text files that options of operators name.
#pragma once

#include <string>
#include <string_view>

namespace pointsweep {

/// The bytes with which some editors begin a UTF-8 file.
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

inline std::string_view without_byte_order_mark(std::string_view text) {
  return text.starts_with(kByteOrderMark) ? text.substr(kByteOrderMark.size()) : text;
}

/// Returns the whole content of a file, without a byte order mark. `holds` tells in messages what the file should hold:
/// "polygons as WKT or GeoJSON". Throws Error if the file cannot be read or has more than 256 MB.
std::string read_text_file(const std::string& path, std::string_view holds);

/// Returns 16 hexadecimal digits that distinguish contents (FNV-1a hash).
std::string checksum_of_text(std::string_view text);

}  // namespace pointsweep
