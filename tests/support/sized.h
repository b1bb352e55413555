// SPDX-License-Identifier: MIT
/// Sizes of clouds of tests: smaller under sanitizers, where every step takes ten times as long, and brute force takes
/// time proportional to the square of the size.
#pragma once

#include <cstddef>

#include "tests/support/sanitizers.h"

namespace pointsweep {

inline std::size_t sized(std::size_t points) {
  return has_thread_sanitizer() ? points / 4 : has_address_sanitizer() ? points / 2 : points;
}

}  // namespace pointsweep
