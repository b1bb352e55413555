// SPDX-License-Identifier: MIT
/// The parts of PLY that the contenders need: binary little-endian, vertices first, no lists. This reader deliberately
/// shares no code with the library.
#pragma once

#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "bench/normals/records.h"

namespace bench {

/// A whole file in memory: the lines of its header and its records unchanged.
struct Ply : Records {
  std::vector<std::string> header;                                        ///< lines up to the last vertex property
  std::map<std::string, std::pair<std::size_t, std::string>> properties;  ///< name -> offset, type

  explicit Ply(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    if (!in) give_up(path + ": cannot open");
    read_header(in, path);
    read(in, path);
  }

  /// Returns (offset, type) of property `a` if `b` and `c` follow it and are as wide as `a`; else nothing.
  std::optional<std::pair<std::size_t, std::string>> triple(const std::string& a, const std::string& b,
                                                            const std::string& c) const {
    const auto x = properties.find(a), y = properties.find(b), z = properties.find(c);
    if (x == properties.end() || y == properties.end() || z == properties.end()) return {};
    const std::size_t size = bytes(x->second.second);
    if (y->second.first != x->second.first + size || z->second.first != x->second.first + 2 * size) return {};
    return x->second;
  }

  static std::size_t bytes(const std::string& type) {
    static const std::map<std::string, std::size_t> sizes{{"char", 1},  {"uchar", 1},  {"short", 2},   {"ushort", 2},
                                                          {"int", 4},   {"uint", 4},   {"float", 4},   {"double", 8},
                                                          {"int8", 1},  {"uint8", 1},  {"int16", 2},   {"uint16", 2},
                                                          {"int32", 4}, {"uint32", 4}, {"float32", 4}, {"float64", 8}};
    const auto found = sizes.find(type);
    if (found == sizes.end()) give_up("unknown PLY type " + type);
    return found->second;
  }

 private:
  void read_header(std::ifstream& in, const std::string& path) {
    std::string line, element;
    while (std::getline(in, line) && line != "end_header") {
      std::istringstream words(line);
      std::string first, second, third;
      words >> first >> second >> third;
      if (first == "format" && second != "binary_little_endian") give_up(path + ": not binary_little_endian");
      if (first == "element") element = second;
      if (first == "element" && element == "vertex") count = std::stoull(third);
      if (first == "property" && element == "vertex") {
        properties[third] = {stride, second};
        stride += bytes(second);
      }
      if (element.empty() || element == "vertex") header.push_back(line);
    }
    if (stride == 0) give_up(path + ": no vertices");
  }
};

}  // namespace bench
