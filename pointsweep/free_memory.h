// SPDX-License-Identifier: MIT
/// Returning freed memory to the system at once. Freed memory that the allocator keeps counts as memory of the process.
#pragma once

namespace pointsweep {

/// Returns free memory of the allocator to the system, if the C library supports it.
void return_free_memory() noexcept;

/// Empties a container and frees its memory, which neither clear() nor the assignment of {} does.
template <class Container>
void free_memory_of(Container& container) {
  Container().swap(container);
}

}  // namespace pointsweep
