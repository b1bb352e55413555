// SPDX-License-Identifier: MIT
/// Reads LAS files from the tables of the specification (LAS 1.4 R15), without any code of the library.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tests/formats/las_test_file.h"
#include "tests/support/contents.h"

namespace las_test {

using Values = std::map<std::string, double>;

inline bool has_time(int format) { return format != 0 && format != 2; }
inline bool has_color(int format) {
  return format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
}
inline bool has_nir(int format) { return format == 8 || format == 10; }
inline bool has_waveform(int format) { return format == 4 || format == 5 || format == 9 || format == 10; }

/// Decodes the bytes from 14 to the end of the core record of formats 0 to 5.
inline void decode_legacy(const std::string& r, std::size_t at, Values& v) {
  const auto returns = get<std::uint8_t>(r, at + 14), classes = get<std::uint8_t>(r, at + 15);
  v["return_number"] = returns & 7;
  v["number_of_returns"] = returns >> 3 & 7;
  v["scan_direction_flag"] = returns >> 6 & 1;
  v["edge_of_flight_line"] = returns >> 7;
  v["classification"] = classes & 31;
  v["synthetic"] = classes >> 5 & 1;
  v["key_point"] = classes >> 6 & 1;
  v["withheld"] = classes >> 7;
  v["scan_angle"] = get<std::int8_t>(r, at + 16);
  v["user_data"] = get<std::uint8_t>(r, at + 17);
  v["point_source_id"] = get<std::uint16_t>(r, at + 18);
}

inline void decode_modern(const std::string& r, std::size_t at, Values& v) {
  const auto returns = get<std::uint8_t>(r, at + 14), flags = get<std::uint8_t>(r, at + 15);
  v["return_number"] = returns & 15;
  v["number_of_returns"] = returns >> 4;
  v["synthetic"] = flags & 1;
  v["key_point"] = flags >> 1 & 1;
  v["withheld"] = flags >> 2 & 1;
  v["overlap"] = flags >> 3 & 1;
  v["scanner_channel"] = flags >> 4 & 3;
  v["scan_direction_flag"] = flags >> 6 & 1;
  v["edge_of_flight_line"] = flags >> 7;
  v["classification"] = get<std::uint8_t>(r, at + 16);
  v["user_data"] = get<std::uint8_t>(r, at + 17);
  v["scan_angle"] = get<std::int16_t>(r, at + 18) * 0.006;
  v["point_source_id"] = get<std::uint16_t>(r, at + 20);
}

/// Returns the standard fields of the record at byte `at`, with scaled coordinates.
inline Values decode(const std::string& file, int format, std::size_t at) {
  Values v;
  for (std::size_t a = 0; a < 3; ++a)
    v[std::string(1, "xyz"[a])] =
        get<std::int32_t>(file, at + 4 * a) * get<double>(file, 131 + 8 * a) + get<double>(file, 155 + 8 * a);
  v["intensity"] = get<std::uint16_t>(file, at + 12);
  format >= 6 ? decode_modern(file, at, v) : decode_legacy(file, at, v);
  at += format >= 6 ? 22 : 20;
  if (has_time(format)) v["gps_time"] = get<double>(file, at), at += 8;
  if (has_color(format)) {
    for (const char* color : {"red", "green", "blue"}) v[color] = get<std::uint16_t>(file, at), at += 2;
  }
  if (has_nir(format)) v["nir"] = get<std::uint16_t>(file, at), at += 2;
  if (!has_waveform(format)) return v;
  v["wavepacket_index"] = get<std::uint8_t>(file, at);
  v["wavepacket_offset"] = static_cast<double>(get<std::uint64_t>(file, at + 1));
  v["wavepacket_size"] = get<std::uint32_t>(file, at + 9);
  const char* const floats[] = {"return_point_wave_location", "x_t", "y_t", "z_t"};
  for (std::size_t i = 0; i < 4; ++i) v[floats[i]] = get<float>(file, at + 13 + 4 * i);
  return v;
}

/// A LAS file as bytes, and the facts that its header states.
struct Decoded {
  std::string bytes;
  int minor() const { return bytes[25]; }
  int format() const { return bytes[104]; }
  bool wkt_bit() const { return (bytes[6] & 16) != 0; }
  bool standard_time_bit() const { return (bytes[6] & 1) != 0; }
  double scale(std::size_t axis) const { return get<double>(bytes, 131 + 8 * axis); }
  double offset(std::size_t axis) const { return get<double>(bytes, 155 + 8 * axis); }
  std::size_t record_length() const { return get<std::uint16_t>(bytes, 105); }
  std::size_t count() const {
    const auto wide = minor() >= 4 ? get<std::uint64_t>(bytes, 247) : 0;
    return wide != 0 ? wide : get<std::uint32_t>(bytes, 107);
  }
  Values point(std::size_t i) const {
    return decode(bytes, format(), get<std::uint32_t>(bytes, 96) + i * record_length());
  }
  /// Returns the content of a VLR; "" if the file has no such VLR.
  std::string vlr(const std::string& user, int record) const {
    std::size_t at = get<std::uint16_t>(bytes, 94);
    for (std::uint32_t i = 0; i < get<std::uint32_t>(bytes, 100); ++i) {
      const std::size_t length = get<std::uint16_t>(bytes, at + 20);
      if (bytes.substr(at + 2, 16).c_str() == user && get<std::uint16_t>(bytes, at + 18) == record)
        return bytes.substr(at + 54, length);
      at += 54 + length;
    }
    return "";
  }
  /// Returns the names of the extra bytes.
  std::vector<std::string> extra_names() const {
    std::vector<std::string> names;
    const std::string content = vlr("LASF_Spec", 4);
    for (std::size_t at = 0; at < content.size(); at += 192) names.push_back(content.substr(at + 4, 32).c_str());
    return names;
  }
};

inline Decoded decoded(const std::string& path) { return {pointsweep::contents(path)}; }

}  // namespace las_test
