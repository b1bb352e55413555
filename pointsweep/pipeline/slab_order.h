// SPDX-License-Identifier: MIT
/// The places that the points of a slab take in the canonical order.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/order/stream.h"

namespace pointsweep {

/// Indices of the slab's working records in canonical order.
std::vector<std::uint32_t> order_of(const Stream& stream, const std::vector<std::byte>& records);

/// The inverse: by index, the place within the slab.
std::vector<std::uint32_t> ranks(const Stream& stream, const std::vector<std::byte>& records);

}  // namespace pointsweep
