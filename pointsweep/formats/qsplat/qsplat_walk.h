// SPDX-License-Identifier: MIT
/// The leaves of the trees of a QSplat file, one after the other, in bounded memory, and the meaning of the codes of a
/// node: a sphere inside the sphere of the parent, a normal, a colour (Rusinkiewicz and Levoy, "QSplat", SIGGRAPH 2000,
/// Sections 3.1 and 3.2; the tables come from the released program, file version 11).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {

struct QsplatSphere {
  float x = 0, y = 0, z = 0, radius = 0;
};

/// Returns the sphere with the 13-bit `code` inside `parent`. Its radius is the parent's radius times s/13. Its centre
/// is, on the x axis, the parent's centre plus the parent's radius times (s + 2x)/13 - 1, and likewise with y and z.
/// Here (s, x, y, z) is quadruple number `code`, from 0 and in lexicographic order, of those with s from 1 to 13 and x,
/// y, z from 0 to 13 - s whose centre is at most 1 + √3 s/13 times the parent's radius away from the parent's centre.
/// Evaluated in single precision, as in QSplat. Returns nothing for an unused code: the format defines 7,621 codes, and
/// 13 bits hold 8,192.
std::optional<QsplatSphere> qsplat_sphere(unsigned code, const QsplatSphere& parent);

/// Returns the unit normal with the 14-bit `code` (52 face + u) 52 + v: place (u, v) of 52×52 on a face of a cube.
/// Returns (0, 0, 0) for codes of corners outside of the unit sphere, which no encoder writes, and (0, 0, 1) for codes
/// without a face, as in QSplat.
std::array<float, 3> qsplat_normal(unsigned code);

/// Returns red, green and blue, 0 to 255, from 5, 6 and 5 bits, red in the highest.
std::array<std::uint8_t, 3> qsplat_color(unsigned code);

/// The header of one part of a file. A part is a tree or a comment.
struct QsplatFragment {
  std::uint64_t begin = 0, end = 0;  ///< bytes in the file
  bool is_comment = false;
  bool has_color = false;
  std::uint64_t leaves = 0;  ///< number of leaves that the header states
  QsplatSphere root;
  std::uint64_t root_children = 0;
};
constexpr std::uint64_t kQsplatHeader = 40;  ///< bytes of the header of a tree

/// Reads the header at byte `begin`. Throws Error if it is no QSplat 11 header, is truncated, or states more bytes
/// than the file has.
QsplatFragment read_qsplat_fragment(const InputFile& file, std::uint64_t begin);

struct QsplatLeaf {
  QsplatSphere sphere;
  unsigned normal = 0;  ///< 14-bit code
  unsigned color = 0;   ///< 16-bit code, if has_color
  bool has_color = false;
  bool has_normal = true;  ///< false for a tree that consists only of its root
};

/// Walks through the leaves depth first. The file stores the tree breadth first, siblings together. Each group of
/// siblings states the place of the first group of its children; the groups of children of all siblings are
/// consecutive, in the order of the siblings. So a walk moves forward on every level of the tree, and needs one block
/// of the file per level (64 KiB × depth, about 1 MB for 10^8 leaves).
class QsplatWalk {
 public:
  /// One level of the tree in the position of a walk. A position is small (40 bytes × depth), so that a reader can
  /// store many positions and resume walks from them.
  struct Level {
    std::uint64_t next = 0;   ///< byte of the next sibling
    std::uint64_t below = 0;  ///< byte of the next group of children; 0 if the siblings are all leaves
    std::uint64_t left = 0;   ///< siblings that remain
    QsplatSphere parent;
  };
  /// The position of a walk.
  struct Place {
    QsplatFragment fragment;
    std::uint64_t walked = 0;  ///< bytes of groups entered in this fragment
    std::uint64_t given = 0;   ///< leaves returned from this fragment
    std::vector<Level> levels;
  };

  explicit QsplatWalk(const InputFile& file) : file_(file) {}
  const Place& place() const { return place_; }
  void go_to(const Place& place) { place_ = place; }

  /// Finds the next leaf. Returns false at the end of the file. Throws Error for a tree that contradicts itself or its
  /// header, or is deeper than 256 levels.
  bool next(QsplatLeaf& leaf);

 private:
  struct Block {
    std::uint64_t begin = 0;
    std::vector<std::byte> bytes;
  };
  bool enter_next_fragment(QsplatLeaf& leaf, bool& is_leaf);
  void enter_group(std::uint64_t begin, std::uint64_t siblings, bool has_pointer, const QsplatSphere& parent);
  void check_end_of_fragment() const;
  /// Returns `size` bytes at `offset`, from the block of a level.
  const std::byte* bytes_at(std::size_t level, std::uint64_t offset, std::size_t size);
  [[noreturn]] void complain(std::uint64_t offset, std::string_view what) const;

  const InputFile& file_;
  Place place_;
  std::vector<Block> blocks_;
};

}  // namespace pointsweep
