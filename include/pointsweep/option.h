// SPDX-License-Identifier: MIT
/// Typed values of the options of operators and rules.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// The value of an option: a whole number, a number, a word or text, or a point; std::monostate if it has no value.
using OptionValue = std::variant<std::monostate, std::uint64_t, double, std::string, Vec3>;

inline bool has_value(const OptionValue& value) { return !std::holds_alternative<std::monostate>(value); }

/// An option that has a value, e.g. {"width", 0.5}.
struct Option {
  std::string name;
  OptionValue value;

  friend bool operator==(const Option&, const Option&) = default;
};

/// All options of an object, in the order of their declaration.
using Options = std::vector<Option>;

}  // namespace pointsweep
