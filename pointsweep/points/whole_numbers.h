// SPDX-License-Identifier: MIT
/// Fields whose values are whole numbers, and reading of whole numbers with all 64 bits.
#pragma once

#include <cstddef>
#include <cstdint>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Returns whether the values of the field are whole numbers: it stores integers, without scale and offset.
bool has_whole_numbers(const Field& field);

/// Returns a value of a field for which has_whole_numbers() is true, bit for bit: an unsigned value of 2^63 or more
/// becomes negative.
std::int64_t whole_number_of(const Field& field, const std::byte* record, std::uint32_t component = 0);

}  // namespace pointsweep
