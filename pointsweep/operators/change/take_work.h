// SPDX-License-Identifier: MIT
/// The rules of `take`, which its bound() and bound_to_other() complete, and its work on the points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/expressions/named_values.h"

namespace pointsweep {

/// An attribute that `take` reads from the other cloud, and the component of a made attribute that gets its values.
struct TakenAttribute {
  std::string name;           ///< name in the user's spelling
  Attribute source;           ///< attribute of the other cloud, with the name and the type of its field
  bool is_color = false;      ///< true for red, green or blue of 8 or 16 bits, if the other cloud has all three
  std::size_t target = 0;     ///< index in TakeRules::targets
  std::size_t component = 0;  ///< component of the made attribute
  TargetRange range = {};
  std::size_t from = 0, to = 0;  ///< offsets in the records read from the other cloud, and in the made records
};

/// An attribute that `take` makes. Some or all of its components come from the other cloud.
struct TakeTarget {
  Attribute made;
  std::optional<Attribute> old;  ///< previous version, which the operator reads; absent for a new attribute
};

struct TakeRules {
  TakeOptions options;
  std::string place;  ///< beginning of messages
  std::vector<TakenAttribute> taken = {};
  std::vector<TakeTarget> targets = {};
};

/// Reads the other cloud and returns the work. Throws Error if the other cloud has no point with a finite place.
/// `rules` are the rules of a bound operator.
std::unique_ptr<InOrderWork> start_taking(TakeRules rules, const InOrderSetup& setup);

/// Returns the least memory of the work. `value_bytes`: bytes of the values taken from a point.
std::uint64_t least_taking_bytes(std::uint64_t k, std::uint64_t value_bytes);

}  // namespace pointsweep
