// SPDX-License-Identifier: MIT
/// Values of the other byte order.
#pragma once

#include <cstddef>
#include <span>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Reverses the bytes of every value of `fields` in records of `stride` bytes.
void reverse_values(std::span<const Field> fields, std::size_t stride, std::span<std::byte> records);

}  // namespace pointsweep
