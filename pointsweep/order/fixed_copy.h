// SPDX-License-Identifier: MIT
/// Copying pieces whose size is known only at run time, with the speed of a size known when compiling.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>

namespace pointsweep {

/// Copies `Bytes` bytes, or `bytes` if `Bytes` is 0.
template <std::size_t Bytes>
inline void copy_bytes(std::byte* to, const std::byte* from, std::size_t bytes) {
  if constexpr (Bytes != 0)
    std::memcpy(to, from, Bytes);
  else
    std::memcpy(to, from, bytes);
}

/// Calls `loop(std::integral_constant<std::size_t, N>)` with N = bytes for the usual sizes, N = 0 for any other.
template <class Loop>
void with_fixed_size(std::size_t bytes, Loop&& loop) {
  switch (bytes) {
    case 1:
      return loop(std::integral_constant<std::size_t, 1>());
    case 2:
      return loop(std::integral_constant<std::size_t, 2>());
    case 4:
      return loop(std::integral_constant<std::size_t, 4>());
    case 8:
      return loop(std::integral_constant<std::size_t, 8>());
    case 12:
      return loop(std::integral_constant<std::size_t, 12>());
    case 16:
      return loop(std::integral_constant<std::size_t, 16>());
    case 20:
      return loop(std::integral_constant<std::size_t, 20>());
    case 24:
      return loop(std::integral_constant<std::size_t, 24>());
    case 28:
      return loop(std::integral_constant<std::size_t, 28>());
    case 32:
      return loop(std::integral_constant<std::size_t, 32>());
    case 36:
      return loop(std::integral_constant<std::size_t, 36>());
    case 64:
      return loop(std::integral_constant<std::size_t, 64>());
    case 72:
      return loop(std::integral_constant<std::size_t, 72>());
    case 96:
      return loop(std::integral_constant<std::size_t, 96>());
    default:
      return loop(std::integral_constant<std::size_t, 0>());
  }
}

}  // namespace pointsweep
