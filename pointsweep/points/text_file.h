// SPDX-License-Identifier: MIT
/// Reading of small text files that users name in options of operators, such as polygons or a matrix.
#pragma once

#include <string>
#include <string_view>

namespace pointsweep {

/// The bytes with which some editors begin a UTF-8 file.
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

inline std::string_view without_byte_order_mark(std::string_view text) {
  return text.starts_with(kByteOrderMark) ? text.substr(kByteOrderMark.size()) : text;
}

/// Returns the whole content of a file, without a byte order mark. `holds`: phrase for the expected content in
/// messages, such as "polygons as WKT or GeoJSON". Throws Error if the file cannot be read or has more than 256 MB.
std::string read_text_file(const std::string& path, std::string_view holds);

/// Returns the 64-bit FNV-1a hash of `text` as 16 hexadecimal digits.
std::string checksum_of_text(std::string_view text);

}  // namespace pointsweep
