// SPDX-License-Identifier: MIT
/// The standard classes of LAS 1.4 (ASPRS, revision 15, Table 17).
#pragma once

#include <cstdint>
#include <string_view>

namespace pointsweep {

/// Returns "Ground", "High vegetation", ...; "Reserved" for 8, 12 and 23 to 63, "User definable" for 64 to 255.
std::string_view name_of_las_class(std::uint8_t code);

}  // namespace pointsweep
