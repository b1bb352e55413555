// SPDX-License-Identifier: MIT
/// The attributes of operators that number the components of a graph.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "pointsweep/attribute.h"
#include "pointsweep/connect/forest_log.h"

namespace pointsweep {

/// Returns whether component numbers and sizes have 32 bits in a cloud of `points` points; false for 0, which means
/// that the number of points is unknown.
bool has_short_numbers(std::uint64_t points);
/// Returns the attribute `name`, N i32 or i64: the number of the component of a point; -1 if it has none.
Attribute component_number(std::string name, std::string meaning, std::uint64_t points);
/// Returns the attribute `name`, N u32 or u64: the number of points in the component of a point.
Attribute component_size(std::string name, std::string meaning, std::uint64_t points);
/// The types of these attributes, for docs/attributes.md.
inline constexpr const char *kNumberTypes = "i32, i64 from 2³¹ rows on", *kSizeTypes = "u32, u64 from 2³¹ rows on";
/// Writes the number and the size of a component to `values`: 32 bits each if `is_short`, else 64 bits each.
void put_component(const ComponentLabel& label, bool is_short, std::byte* values);

}  // namespace pointsweep
