// SPDX-License-Identifier: MIT
/// The value that some points of another cloud give to a point, and the attribute that it goes to.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/operators.h"
#include "pointsweep/operators/expressions/assigned_target.h"

namespace pointsweep {

/// An attribute that `take` gives to the points.
struct TakenAttribute {
  std::string name;           ///< as the user writes it
  Attribute source;           ///< of the other cloud, with the name and the type of its field
  bool is_color = false;      ///< red, green or blue of three that have 8 or 16 bits in the other cloud
  std::size_t target = 0;     ///< number of the attribute that is made
  std::size_t component = 0;  ///< of that attribute
  TargetRange range = {};
  std::size_t from = 0, to = 0;  ///< bytes before it in what is read of the other cloud, and in what is made
};

/// What k values give: a whole number, which is exact, or another number.
struct VotedValue {
  bool is_whole = false;
  WholeNumber whole = 0;
  double real = 0;

  double number() const { return is_whole ? static_cast<double>(whole) : real; }
};

/// Returns what the values of `taken` give in `records`, which lie `record_bytes` apart, those of the nearest point
/// first. Nothing if there are none, or none that is finite: NaN and infinite values have no vote, but the value of the
/// only or nearest point is taken as it is. A colour has the brightness of its target; one of 16 bits is rounded to 8
/// bits, halves to even.
std::optional<VotedValue> voted_value(const TakenAttribute& taken, TakeVote vote, std::span<const std::byte> records,
                                      std::size_t record_bytes);

/// Writes the value into a record of what is made. Returns false for a value that the attribute cannot hold, whole
/// numbers as whole numbers. `rounds`: fractions are rounded to whole-number types, halves to even.
bool put_value(const VotedValue& value, const TakenAttribute& taken, bool rounds, std::byte* record);

}  // namespace pointsweep
