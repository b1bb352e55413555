// SPDX-License-Identifier: MIT
/// The value that points of another cloud give to a point, and the attribute that receives it.
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
  std::string name;           ///< name in the user's spelling
  Attribute source;           ///< attribute of the other cloud, with the name and the type of its field
  bool is_color = false;      ///< true for red, green or blue of 8 or 16 bits, if the other cloud has all three
  std::size_t target = 0;     ///< index in the attributes that `take` makes
  std::size_t component = 0;  ///< component of the made attribute
  TargetRange range = {};
  std::size_t from = 0, to = 0;  ///< offsets in the records read from the other cloud, and in the made records
};

/// The result of a vote: `whole` if `is_whole`, else `real`.
struct VotedValue {
  bool is_whole = false;
  WholeNumber whole = 0;
  double real = 0;

  double number() const { return is_whole ? static_cast<double>(whole) : real; }
};

/// Returns the result of the vote over the values of `taken` in `records`, which are `record_bytes` apart, nearest
/// point first. Returns nullopt if there is no record or no value votes: NaN and infinite values have no vote, except
/// that `nearest`, and `majority` over one record, take any value unchanged. A colour gets the range of its target; 16
/// bits are rounded to 8 bits, halves to even.
std::optional<VotedValue> voted_value(const TakenAttribute& taken, TakeVote vote, std::span<const std::byte> records,
                                      std::size_t record_bytes);

/// Writes the value into a made record; whole numbers stay exact. Returns false for a value that the attribute cannot
/// hold. `rounds`: true if fractions are rounded for whole-number types, halves to even.
bool put_value(const VotedValue& value, const TakenAttribute& taken, bool rounds, std::byte* record);

}  // namespace pointsweep
