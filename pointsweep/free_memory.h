// SPDX-License-Identifier: MIT
/// The memory of this process. Freed memory that the allocator keeps counts as memory of the process; functions here
/// return it to the system at once.
#pragma once

#include <cstdint>

namespace pointsweep {

/// Returns the resident set of this process in bytes; 2^63 if the system does not tell.
std::uint64_t resident_bytes();

/// Returns free memory of the allocator to the system, if the C library supports it.
void return_free_memory() noexcept;

/// Empties a container and frees its memory, which neither clear() nor the assignment of {} does.
template <class Container>
void free_memory_of(Container& container) {
  Container().swap(container);
}

}  // namespace pointsweep
