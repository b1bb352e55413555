// SPDX-License-Identifier: MIT
/// Values of attributes in memory as numbers. Whole numbers of 64 bits stay exact.
#pragma once

#include <cstddef>

#include "pointsweep/points/schema.h"
#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep {

/// Converts the value of `field` in `record` to `type`, the type that stages read, and stores it at `to`.
void put_value(const Field& field, const std::byte* record, Type type, std::byte* to);

/// Returns component number `component` of the value.
formulas::Real number_in(Type type, const std::byte* value, std::size_t component = 0);

}  // namespace pointsweep
