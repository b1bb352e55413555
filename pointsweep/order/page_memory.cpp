// SPDX-License-Identifier: MIT
#include "pointsweep/order/page_memory.h"

#include <sys/mman.h>

#include <limits>

#include "pointsweep/fail.h"

namespace pointsweep {

PageMemory::PageMemory(std::uint64_t bytes) {
  if (bytes == 0) return;
  void* address = MAP_FAILED;
  if (bytes <= std::numeric_limits<std::size_t>::max() / 2)
    address = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (address == MAP_FAILED)
    fail("the system refuses {} bytes of memory: set a smaller --memory, so that more is kept in the temporary folder.",
         bytes);
#ifdef MADV_HUGEPAGE
  (void)::madvise(address, bytes, MADV_HUGEPAGE);
#endif
  address_ = static_cast<std::byte*>(address);
  bytes_ = bytes;
}

PageMemory::~PageMemory() {
  if (address_ != nullptr) ::munmap(address_, bytes_);
}

}  // namespace pointsweep
