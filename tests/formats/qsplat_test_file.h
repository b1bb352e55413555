// SPDX-License-Identifier: MIT
/// QSplat files made by the tests: trees of codes, written breadth first as the released program does. Their leaves are
/// found by plain recursion from a list of all codes.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <random>
#include <string>
#include <vector>

namespace pointsweep::qsplat_test {

struct Node {
  unsigned sphere = 0, normal = 0, color = 0;  ///< codes
  std::vector<Node> children;
};

inline bool has_grandchildren(const Node& node) {
  for (const Node& child : node.children) {
    if (!child.children.empty()) return true;
  }
  return false;
}

inline std::size_t leaves_of(const Node& node) {
  if (node.children.empty()) return 1;
  std::size_t leaves = 0;
  for (const Node& child : node.children) leaves += leaves_of(child);
  return leaves;
}

inline void put(std::string& to, std::uint32_t value, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) to += static_cast<char>(value >> 8 * i & 255);
}
inline void put(std::string& to, float value) { put(to, std::bit_cast<std::uint32_t>(value), 4); }

struct Tree {
  std::array<float, 4> root_sphere = {10, 20, 30, 2};
  Node root;
  bool has_color = false;

  std::size_t group_size(const Node& node) const {
    if (node.children.empty()) return 0;
    return node.children.size() * (has_color ? 6 : 4) + (has_grandchildren(node) ? 4 : 0);
  }

  std::string nodes() const {
    std::string out;
    std::deque<const Node*> waiting = {&root};
    std::size_t waiting_bytes = group_size(root);
    while (!waiting.empty()) {
      const Node& node = *waiting.front();
      waiting.pop_front();
      if (has_grandchildren(node)) put(out, static_cast<std::uint32_t>(waiting_bytes), 4);
      waiting_bytes -= group_size(node);
      for (const Node& child : node.children) {
        const auto n = static_cast<unsigned>(child.children.size());
        put(out, child.sphere << 3 | (n == 0 ? 0 : n - 1) | (has_grandchildren(child) ? 4 : 0), 2);
        put(out, child.normal << 2 | 1, 2);
        if (has_color) put(out, child.color, 2);
        if (n == 0) continue;
        waiting.push_back(&child);
        waiting_bytes += group_size(child);
      }
    }
    return out;
  }

  std::string bytes() const {
    std::string body = nodes();
    body.resize((body.size() + 3) / 4 * 4, '\0');
    std::string out = "QSplat11";
    put(out, static_cast<std::uint32_t>(40 + body.size()), 4);
    put(out, static_cast<std::uint32_t>(leaves_of(root)), 4);
    put(out, has_color ? 1 : 0, 4);
    for (const float value : root_sphere) put(out, value);
    put(out, static_cast<std::uint32_t>(root.children.size()), 4);
    return out + body;
  }
};

inline std::string comment(std::string text) {
  text.resize((text.size() + 3) / 4 * 4, '\0');
  std::string out = "QSplat11";
  put(out, static_cast<std::uint32_t>(20 + text.size()), 4);
  put(out, 0, 4);
  put(out, 2, 4);
  return out + text;
}

/// Returns (s, x, y, z) of every code: a cube of s cells at cell (x, y, z) of a grid of 13³ cells. A cube has a code if
/// its circumscribed sphere meets the unit sphere, in units of a thirteenth: (13 · centre)² <= (13 + √3 s)².
inline const std::vector<std::array<int, 4>>& cubes() {
  static const std::vector<std::array<int, 4>> all = [] {
    std::vector<std::array<int, 4>> cubes;
    for (int s = 1; s <= 13; ++s) {
      for (int i = 0; i < (14 - s) * (14 - s) * (14 - s); ++i) {
        const int x = i / ((14 - s) * (14 - s)), y = i / (14 - s) % (14 - s), z = i % (14 - s);
        const auto square = [s](int place) { return (s + 2 * place - 13) * (s + 2 * place - 13); };
        if (square(x) + square(y) + square(z) <= 169 + 26 * std::sqrt(3.0) * s + 3 * s * s)
          cubes.push_back({s, x, y, z});
      }
    }
    return cubes;
  }();
  return all;
}

struct Leaf {
  std::array<float, 4> sphere;
  unsigned normal, color;
};

inline void collect(const Node& node, const std::array<float, 4>& sphere, std::vector<Leaf>& leaves) {
  if (node.children.empty()) leaves.push_back({sphere, node.normal, node.color});
  for (const Node& child : node.children) {
    const auto cube = cubes()[child.sphere];
    std::array<float, 4> inner{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float relative = static_cast<float>(cube[0] + 2 * cube[axis + 1]) * (1.0f / 13) - 1;
      inner[axis] = sphere[axis] + sphere[3] * relative;
    }
    inner[3] = sphere[3] * (static_cast<float>(cube[0]) * (1.0f / 13));
    collect(child, inner, leaves);
  }
}

/// Returns the leaves of the tree, depth first.
inline std::vector<Leaf> leaves_in(const Tree& tree) {
  std::vector<Leaf> leaves;
  collect(tree.root, tree.root_sphere, leaves);
  return leaves;
}

/// Returns a node with about `leaves` leaves, split unevenly.
inline Node random_node(std::mt19937& random, unsigned leaves) {
  Node node{static_cast<unsigned>(random() % cubes().size()),
            static_cast<unsigned>(random() % 16384),
            static_cast<unsigned>(random() % 65536),
            {}};
  if (leaves < 2) return node;
  const auto children = static_cast<unsigned>(2 + random() % 3);
  for (unsigned i = 0; i < children; ++i) {
    node.children.push_back(random_node(random, i == 0 ? leaves / 2 : leaves / 2 / (children - 1)));
  }
  return node;
}

inline Tree random_tree(unsigned leaves, bool has_color) {
  std::mt19937 random(7);
  return {{10, 20, 30, 2}, random_node(random, leaves), has_color};
}

}  // namespace pointsweep::qsplat_test
