// SPDX-License-Identifier: MIT
/// The values that names mean: a name that a user writes for a single value, in conditions, assignments and options
/// that name an attribute, and the exact name of an attribute that an operator reads.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "pointsweep/attribute.h"

namespace pointsweep {

/// A component of a made attribute, or a field of the input, that a name means. Both pointers are null if the name
/// means nothing.
struct MeantValue {
  const Attribute* made = nullptr;
  std::size_t component = 0;     ///< component of `made`
  const Field* field = nullptr;  ///< field of the input; null if `made` is not null
};

/// Returns the value that `word` names, in any spelling that files use. A made attribute precedes a field of the input
/// unless `word` is a spelling of several attributes, as "curvature" is, and the exact name of a field of the input.
/// Moved positions are never returned: x, y and z mean the fields of the input.
MeantValue meant_value(const std::string& word, const Schema& input, std::span<const Attribute> made);

/// Returns the value that `word` names in an expression: meant_value(). If that finds nothing for "row", returns the
/// number of the row in the inputs (input_row.h).
MeantValue value_in_expression(const std::string& word, const Schema& input, std::span<const Attribute> made);

/// Returns the type of a field of the input; for packed bits the smallest type that holds them, for scaled numbers
/// float64.
Type type_of_values(const Field& field);

/// Returns the attribute `name` if an earlier stage makes it and it has one value, else the field `name` of the input
/// as float64; nullopt if there is none.
std::optional<Attribute> single_value(const char* name, const Schema& input, std::span<const Attribute> made);

}  // namespace pointsweep
