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

/// Sets up the allocator of the whole process so that it holds little free memory, even with many threads. A program
/// calls this function before its first thread; a library must not.
void keep_little_free_memory() noexcept;

}  // namespace pointsweep
