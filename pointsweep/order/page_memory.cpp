// SPDX-License-Identifier: MIT
#include "pointsweep/order/page_memory.h"

#include <sys/mman.h>

#include <algorithm>
#include <cassert>
#include <limits>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

constexpr std::size_t kAlignment = 64;
constexpr std::size_t kLeastPiece = std::size_t{256} << 10, kLargestPiece = std::size_t{32} << 20;

}  // namespace

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

BlockPool::BlockPool(std::size_t block_bytes)
    : block_bytes_((block_bytes + kAlignment - 1) / kAlignment * kAlignment) {}

std::byte* BlockPool::take() {
  const std::lock_guard lock(mutex_);
  std::byte* block = nullptr;
  if (!free_.empty()) {
    block = free_.back();
    free_.pop_back();
  } else {
    if (pieces_.empty() || piece_used_ == pieces_.back().size()) {
      const std::size_t aim = std::clamp(held_ / 4, kLeastPiece, kLargestPiece);  // keeps the unused memory small
      pieces_.emplace_back(std::max<std::size_t>(1, aim / block_bytes_) * block_bytes_);
      held_ += pieces_.back().size();
      piece_used_ = 0;
    }
    block = pieces_.back().data() + piece_used_;
    piece_used_ += block_bytes_;
  }
  ++taken_;
  return block;
}

void BlockPool::give_back(std::byte* block) {
  const std::lock_guard lock(mutex_);
  free_.push_back(block);
  --taken_;
}

void BlockPool::clear() {
  const std::lock_guard lock(mutex_);
  assert(taken_ == 0);
  free_.clear();
  pieces_.clear();
  held_ = 0;
}

std::size_t BlockPool::taken_bytes() const {
  const std::lock_guard lock(mutex_);
  return taken_ * block_bytes_;
}

}  // namespace pointsweep
