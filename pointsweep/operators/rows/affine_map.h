// SPDX-License-Identifier: MIT
/// Affine maps of space: p' = A p + t.
#pragma once

#include <array>
#include <string>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// The first three rows of a 4x4 matrix whose last row is 0 0 0 1. The default map moves nothing.
struct AffineMap {
  using Row = std::array<double, 4>;
  std::array<Row, 3> rows = {Row{1, 0, 0, 0}, Row{0, 1, 0, 0}, Row{0, 0, 1, 0}};

  /// Returns ((a x + b y) + c z) + t in each coordinate, whose row is {a, b, c, t}.
  Vec3 moved(Vec3 p) const;
  /// Returns A v.
  Vec3 turned(Vec3 v) const;
  /// Returns Aᵀ v.
  Vec3 turned_by_transpose(Vec3 v) const;
  /// Returns the map that moves points back. Throws UsageError, beginning with `place`, for a map onto a plane, a line
  /// or a point: |det| of A, with its rows scaled to length 1, is at most 1e-12. Also throws it if det A is not a
  /// normal number.
  AffineMap inverse(const std::string& place) const;
};

/// Returns the map of 12 or 16 numbers, row by row, separated by commas, semicolons, brackets, blanks or ends of lines.
/// The argument is a text with the numbers, or the name of a file with them; lines that begin with # are comments. For
/// an invalid matrix, throws Error if it is in a file, else UsageError that begins with `place`.
AffineMap affine_map_of(const std::string& text_or_file, const std::string& place);

}  // namespace pointsweep
