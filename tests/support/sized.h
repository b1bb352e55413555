// SPDX-License-Identifier: MIT
/// Clouds of tests are smaller under sanitizers, where every step costs ten times as much and brute force the square.
#pragma once

#include <cstddef>

namespace pointsweep {

#if defined(__SANITIZE_THREAD__)
constexpr std::size_t sized(std::size_t points) { return points / 4; }
#elif defined(__SANITIZE_ADDRESS__)
constexpr std::size_t sized(std::size_t points) { return points / 2; }
#else
constexpr std::size_t sized(std::size_t points) { return points; }
#endif

}  // namespace pointsweep
