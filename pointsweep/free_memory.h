// SPDX-License-Identifier: MIT
/// Functions that free memory, and that return freed memory to the system at once. Memory that is free but still with
/// the allocator counts as memory of the process.
#pragma once

#include <cstdint>

namespace pointsweep {

/// Returns free memory of the allocator to the system, if the C library supports it.
void return_free_memory() noexcept;

/// Calls return_free_memory() if the resident set of this process exceeds `bytes` or is unknown. A call takes
/// milliseconds, so memory that later work uses again should stay with the allocator while the budget has room for it.
void return_free_memory_above(std::uint64_t bytes);

/// Empties a container and frees its memory, unlike clear() and the assignment of {}.
template <class Container>
void free_memory_of(Container& container) {
  Container().swap(container);
}

}  // namespace pointsweep
