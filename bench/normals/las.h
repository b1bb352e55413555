// SPDX-License-Identifier: MIT
/// The parts of LAS that the contenders need: 1.2 to 1.4, uncompressed, without bytes after the points. This reader
/// deliberately shares no code with the library.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "bench/normals/records.h"

namespace bench {

/// Bytes of a normal, which the programs append to each record.
inline constexpr std::size_t kNormalBytes = 12;

/// A whole file in memory: the bytes before the points, and the unchanged records.
struct Las : Records {
  std::vector<char> head;  ///< header and VLRs, up to the first point

  Las() = default;
  explicit Las(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    if (!in) give_up(path + ": cannot open");
    read_head(in, path);
    read(in, path);
  }

  template <class T>
  T entry(std::size_t at) const {
    return value_at<T>(head.data() + at);
  }
  template <class T>
  void set_entry(std::size_t at, T value) {
    std::memcpy(head.data() + at, &value, sizeof value);
  }

  std::array<double, 3> scale() const { return entry<std::array<double, 3>>(131); }
  std::array<double, 3> offset() const { return entry<std::array<double, 3>>(155); }
  /// Returns the lowest and the highest coordinate of an axis, from the box in the header, in steps of the scale.
  std::array<double, 2> range(std::size_t axis) const {
    const auto steps = [&](std::size_t at) { return (entry<double>(at) - offset()[axis]) / scale()[axis]; };
    return {steps(187 + 16 * axis), steps(179 + 16 * axis)};
  }
  std::int32_t step(std::size_t i, std::size_t axis) const { return get<std::int32_t>(i, 4 * axis); }

 private:
  void read_head(std::ifstream& in, const std::string& path) {
    head.resize(227);
    in.read(head.data(), std::streamsize(head.size()));
    if (!in || std::memcmp(head.data(), "LASF", 4) != 0) give_up(path + ": no LAS file");
    const auto minor = entry<std::uint8_t>(25);
    if (entry<std::uint8_t>(24) != 1 || minor < 2 || minor > 4) give_up(path + ": not LAS 1.2 to 1.4");
    if (entry<std::uint8_t>(104) > 10) give_up(path + ": compressed");
    const auto begin = entry<std::uint32_t>(96);
    if (begin < (minor == 4 ? 375u : 227u)) give_up(path + ": points begin inside the header");
    head.resize(begin);
    in.read(head.data() + 227, std::streamsize(begin - 227));
    if (!in) give_up(path + ": truncated");
    stride = entry<std::uint16_t>(105);
    count = entry<std::uint32_t>(107);
    if (minor == 4 && count == 0) count = entry<std::uint64_t>(247);
    if (stride < 20) give_up(path + ": records too short");
    if (minor == 4 && entry<std::uint32_t>(243) != 0) give_up(path + ": has extended VLRs");
  }
};

}  // namespace bench
