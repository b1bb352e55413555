// SPDX-License-Identifier: MIT
/// LAS files made byte by byte from the tables of the specification, without any code of the library.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace las_test {

/// Record lengths in bytes of point formats 0 to 10 (LAS 1.4 R15, tables 7 to 17).
inline constexpr std::array<int, 11> kRecordLength{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

template <class T>
T get(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

inline std::string random_bytes(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::string bytes(count, '\0');
  for (char& c : bytes) c = static_cast<char>(random());
  return bytes;
}

/// Returns a VLR; with `extended`, an EVLR.
inline std::string vlr(const std::string& user, std::uint16_t record, const std::string& content,
                       bool extended = false) {
  std::string bytes(extended ? 60 : 54, '\0');
  bytes.replace(2, user.size(), user);
  put(bytes, 18, record);
  extended ? put(bytes, 20, std::uint64_t{content.size()}) : put(bytes, 20, static_cast<std::uint16_t>(content.size()));
  bytes.replace(extended ? 28 : 22, 6, "a note");
  return bytes + content;
}

/// Returns a descriptor of an extra-bytes VLR.
inline std::string descriptor(const std::string& name, int type, int options = 0, std::array<double, 3> scale = {},
                              std::array<double, 3> offset = {}) {
  std::string bytes(192, '\0');
  bytes[2] = static_cast<char>(type);
  bytes[3] = static_cast<char>(options);
  bytes.replace(4, name.size(), name);
  put(bytes, 112, scale);
  put(bytes, 136, offset);
  return bytes;
}

struct File {
  int minor = 2;
  int format = 0;
  int extra_bytes = 0;  ///< number of bytes of each record after the fields of the format
  std::size_t count = 100;
  std::string user_header;  ///< bytes after the standard header
  std::vector<std::string> vlrs;
  std::string padding;  ///< between the VLRs and the points
  std::vector<std::string> evlrs;
  std::array<double, 3> scale{0.01, 0.001, 0.25}, offset{500000, -20.5, 0};
  unsigned seed = 1;

  std::size_t header_size() const { return (minor == 4 ? 375 : minor == 3 ? 235 : 227) + user_header.size(); }
  std::size_t record_length() const { return static_cast<std::size_t>(kRecordLength[format] + extra_bytes); }
  std::string points() const { return random_bytes(count * record_length(), seed); }

  std::size_t points_at() const {
    std::size_t at = header_size() + padding.size();
    for (const std::string& v : vlrs) at += v.size();
    return at;
  }

  std::string bytes() const {
    std::string header = random_bytes(header_size(), seed + 1);  // copies must keep unused bytes, too
    header.replace(0, 4, "LASF");
    header[24] = 1;
    header[25] = static_cast<char>(minor);
    put(header, 94, static_cast<std::uint16_t>(header_size()));
    put(header, 96, static_cast<std::uint32_t>(points_at()));
    put(header, 100, static_cast<std::uint32_t>(vlrs.size()));
    header[104] = static_cast<char>(format);
    put(header, 105, static_cast<std::uint16_t>(record_length()));
    put(header, 131, scale);
    put(header, 155, offset);
    put_statistics(header);
    if (minor >= 3) put(header, 227, std::uint64_t{0});
    if (minor == 4) {
      put(header, 235, std::uint64_t{evlrs.empty() ? 0 : points_at() + count * record_length()});
      put(header, 243, static_cast<std::uint32_t>(evlrs.size()));
    }
    std::string all = header.substr(0, header_size() - user_header.size()) + user_header;
    for (const std::string& v : vlrs) all += v;
    all += padding + points();
    for (const std::string& v : evlrs) all += v;
    return all;
  }

  /// Writes the counts and bounds that the specification requires.
  void put_statistics(std::string& header) const {
    const std::string records = points();
    std::array<std::uint64_t, 16> by_return{};
    std::array<double, 3> lo{}, hi{};
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = i * record_length();
      ++by_return[static_cast<std::uint8_t>(records[at + 14]) & (format >= 6 ? 15 : 7)];
      for (std::size_t a = 0; a < 3; ++a) {
        const double v = get<std::int32_t>(records, at + 4 * a) * scale[a] + offset[a];
        lo[a] = i == 0 ? v : std::min(lo[a], v);
        hi[a] = i == 0 ? v : std::max(hi[a], v);
      }
    }
    const bool legacy = format <= 5;
    put(header, 107, static_cast<std::uint32_t>(legacy ? count : 0));
    for (std::size_t r = 0; r < 5; ++r) {
      put(header, 111 + 4 * r, static_cast<std::uint32_t>(legacy ? by_return[r + 1] : 0));
    }
    for (std::size_t a = 0; a < 3; ++a) {
      put(header, 179 + 16 * a, hi[a]);
      put(header, 187 + 16 * a, lo[a]);
    }
    if (minor < 4) return;
    put(header, 247, std::uint64_t{count});
    for (std::size_t r = 0; r < 15; ++r) put(header, 255 + 8 * r, by_return[r + 1]);
  }
};

}  // namespace las_test
