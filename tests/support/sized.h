// SPDX-License-Identifier: MIT
/// Clouds of tests are smaller under sanitizers, where every step costs ten times as much and brute force the square.
#pragma once

#include <cstddef>

#include "tests/support/sanitizers.h"

namespace pointsweep {

inline std::size_t sized(std::size_t points) {
  return has_thread_sanitizer() ? points / 4 : has_address_sanitizer() ? points / 2 : points;
}

}  // namespace pointsweep
