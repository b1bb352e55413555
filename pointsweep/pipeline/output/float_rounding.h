// SPDX-License-Identifier: MIT
/// The loss of coordinates that an output stores as float32.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/geometry.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Sees the records of an output, and says by how much its coordinates may have been rounded to float32.
class FloatRounding {
 public:
  /// `input`: the fields of the input; `output`: those of the records. Sees nothing unless the output has coordinates
  /// of float32 and the input has others, or a stage moves the points.
  FloatRounding(const Schema& input, const std::vector<Attribute>& made, const Schema& output);

  /// Takes whole records of the output.
  void see(std::span<const std::byte> records);
  /// "x, y and z are stored as float32, which rounds them by at most 0.25; ...": half a step of float32 at the
  /// coordinate farthest from 0, and the move that would make it at least 16 times smaller, if there is one. Empty where
  /// nothing is rounded.
  std::string sentence() const;

 private:
  std::optional<PositionFields> narrowed_;
  std::size_t stride_;
  Box box_;  ///< of the finite coordinates
};

}  // namespace pointsweep
