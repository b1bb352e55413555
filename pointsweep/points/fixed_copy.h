// SPDX-License-Identifier: MIT
/// Copies of pieces whose size is known only at run time, as fast as with a size known at compile time.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>

namespace pointsweep {

/// Copies `Bytes` bytes, or `bytes` if `Bytes` is 0.
template <std::size_t Bytes>
inline void copy_bytes(std::byte* to, const std::byte* from, std::size_t bytes) {
  if constexpr (Bytes != 0)
    std::memcpy(to, from, Bytes);
  else
    std::memcpy(to, from, bytes);
}

/// Calls `loop(std::integral_constant<std::size_t, N>)` with N = bytes for the usual sizes, which are 1, 2 and the
/// multiples of 4 up to 96, and N = 0 for any other.
template <class Loop>
void with_fixed_size(std::size_t bytes, Loop&& loop) {
  const auto called = [&]<std::size_t Bytes>(std::integral_constant<std::size_t, Bytes> size) {
    if (bytes == Bytes) loop(size);
    return bytes == Bytes;
  };
  const bool found = [&]<std::size_t... I>(std::index_sequence<I...>) {
    return (called(std::integral_constant<std::size_t, 4 * (I + 1)>()) || ...);
  }
  (std::make_index_sequence<24>());
  if (found || called(std::integral_constant<std::size_t, 1>()) || called(std::integral_constant<std::size_t, 2>()))
    return;
  loop(std::integral_constant<std::size_t, 0>());
}

}  // namespace pointsweep
