// SPDX-License-Identifier: MIT
/// The instruction set that the vector code of this process runs with.
#pragma once

#include <string_view>

namespace pointsweep {

/// Highway's name of the best instruction set that the library is built for and this processor has: "AVX3" (AVX-512),
/// "AVX2", "SSE4", "NEON", ... It changes the speed and no result.
std::string_view instruction_set_in_use();

}  // namespace pointsweep
