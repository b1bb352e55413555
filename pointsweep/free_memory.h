// SPDX-License-Identifier: MIT
/// Memory that the allocator has been given back. It counts as the process's own until the system has it.
#pragma once

namespace pointsweep {

/// Gives free memory of the allocator to the system, where the C library can do so.
void return_free_memory() noexcept;

/// Sets up the allocator of the whole process so that it holds little free memory, for many threads, too. A program
/// calls it before its first thread; a library must not.
void keep_little_free_memory() noexcept;

}  // namespace pointsweep
