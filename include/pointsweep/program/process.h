// SPDX-License-Identifier: MIT
/// Functions for programs about their own process: setting up the allocator, removing unfinished files in a signal
/// handler, the state of the outputs, the instruction set.
#pragma once

#include <string_view>

#include "pointsweep/export.h"

namespace pointsweep {

/// Sets up the allocator of the whole process so that it holds little free memory, even with many threads. A program
/// calls this function before its first thread; a library must not.
POINTSWEEP_EXPORT void keep_little_free_memory() noexcept;

/// Sets up the allocator of the whole process so that it keeps up to about 16 MB of freed memory, which later tasks
/// reuse. For worker processes whose allocator returns freed memory to the system immediately, as Dask sets it.
POINTSWEEP_EXPORT void reuse_free_memory() noexcept;

/// Removes the unfinished files and the empty temporary folders of this process, up to 64 in all. A signal handler may
/// call it, and must then end the process.
POINTSWEEP_EXPORT void remove_leftovers() noexcept;

/// The state of all outputs of this process.
struct OutputsSoFar {
  bool any_is_complete = false;
  bool any_is_streamed = false;  ///< true if bytes have been written to standard output
  /// True if the program that reads standard output has ended before the last byte, as `head` does, while no output
  /// file of this process was incomplete.
  bool reader_has_ended = false;
};
POINTSWEEP_EXPORT OutputsSoFar outputs_so_far();

/// Returns Highway's name of the instruction set that the vector code of this process uses, the best for which the
/// library is built and that this processor has: "AVX3" (AVX-512), "AVX2", "SSE4", "NEON", ... It changes the speed and
/// no result.
POINTSWEEP_EXPORT std::string_view instruction_set_in_use();

}  // namespace pointsweep
