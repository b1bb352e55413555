// SPDX-License-Identifier: MIT
/// Point records of the contenders: unchanged from the file, all in memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

namespace bench {

[[noreturn]] inline void give_up(const std::string& message) {
  std::cerr << message << '\n';
  std::exit(2);
}

template <class T>
T value_at(const char* bytes) {
  T v;
  std::memcpy(&v, bytes, sizeof v);
  return v;
}

struct Records {
  std::size_t count = 0, stride = 0;
  std::vector<char> bytes;

  const char* record(std::size_t i) const { return bytes.data() + i * stride; }
  template <class T>
  T get(std::size_t i, std::size_t offset) const {
    return value_at<T>(record(i) + offset);
  }

  void read(std::ifstream& in, const std::string& path) {
    bytes.resize(count * stride);
    in.read(bytes.data(), std::streamsize(bytes.size()));
    if (!in) give_up(path + ": truncated");
  }
};

/// Writes `count` records of `stride` bytes, 4 MB at a time; fill(i, to) writes all bytes of record i to `to`.
template <class Fill>
void write_records(std::ofstream& out, const std::string& path, std::size_t count, std::size_t stride, Fill fill) {
  const std::size_t in_block = std::max<std::size_t>(1, (std::size_t{4} << 20) / stride);
  std::vector<char> block(std::min(in_block, count) * stride);
  for (std::size_t i = 0; i < count;) {
    const std::size_t n = std::min(in_block, count - i);
    for (std::size_t j = 0; j < n; ++j, ++i) fill(i, block.data() + j * stride);
    out.write(block.data(), std::streamsize(n * stride));
  }
  if (!out.flush()) give_up(path + ": cannot write");
}

/// Returns whether the file is LAS, by its name: script/bench makes all files.
inline bool is_las(const std::string& path) { return path.ends_with(".las"); }

}  // namespace bench
