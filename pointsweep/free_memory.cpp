// SPDX-License-Identifier: MIT
#include "pointsweep/free_memory.h"

#include <unistd.h>

#include <cstdlib>  // defines __GLIBC__
#include <fstream>

#include "pointsweep/program/process.h"

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace pointsweep {

void return_free_memory_above(std::uint64_t bytes) {
  std::uint64_t size, resident;  // pages
  const bool is_known = static_cast<bool>(std::ifstream("/proc/self/statm") >> size >> resident);
  if (!is_known || resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) > bytes) return_free_memory();
}

#if defined(__GLIBC__)

void return_free_memory() noexcept { ::malloc_trim(0); }

/// glibc makes up to eight arenas per processor and moves no memory between them. Once a large block has been freed,
/// blocks of its size come from the arenas, too, and leave holes there.
void keep_little_free_memory() noexcept {
  ::mallopt(M_ARENA_MAX, 4);
  ::mallopt(M_MMAP_THRESHOLD, 128 << 10);
  ::mallopt(M_TRIM_THRESHOLD, 4 << 20);
}

/// Dask starts its workers with MALLOC_TRIM_THRESHOLD_=65536, which also fixes M_MMAP_THRESHOLD at 128 kB: each larger
/// block is mapped separately, and the system clears all its pages again.
void reuse_free_memory() noexcept {
  ::mallopt(M_MMAP_THRESHOLD, 1 << 20);
  ::mallopt(M_TRIM_THRESHOLD, 16 << 20);
}

#else

void return_free_memory() noexcept {}
void keep_little_free_memory() noexcept {}
void reuse_free_memory() noexcept {}

#endif

}  // namespace pointsweep
