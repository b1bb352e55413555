// SPDX-License-Identifier: MIT
/// The memory of this process. Freed memory that the allocator keeps counts as memory of the process; functions here
/// return it to the system at once.
#pragma once

#include <cstdint>

namespace pointsweep {

/// Returns free memory of the allocator to the system, if the C library supports it.
void return_free_memory() noexcept;

/// Calls return_free_memory() if the resident set of this process exceeds `bytes`, or if the system does not tell. It
/// takes milliseconds, so memory that later work can use again should stay where the budget has room for it.
void return_free_memory_above(std::uint64_t bytes);

/// Empties a container and frees its memory, which neither clear() nor the assignment of {} does.
template <class Container>
void free_memory_of(Container& container) {
  Container().swap(container);
}

}  // namespace pointsweep
