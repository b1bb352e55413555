// SPDX-License-Identifier: MIT
/// Blocks of one size, cut from pieces of memory that grow with demand.
#pragma once

#include <cstddef>
#include <mutex>
#include <vector>

#include "pointsweep/order/page_memory.h"

namespace pointsweep {

/// A thread-safe pool. Memory returns to the system when the pool is emptied or destroyed, never block by block.
class BlockPool {
 public:
  explicit BlockPool(std::size_t block_bytes);

  /// Returns a block whose content is undefined. The pool owns it.
  std::byte* take();
  void give_back(std::byte* block);
  /// Returns all memory to the system. All blocks must have been returned to the pool.
  void clear();
  /// Returns the bytes of the blocks that are taken now.
  std::size_t taken_bytes() const;

 private:
  std::size_t block_bytes_;
  mutable std::mutex mutex_;
  std::vector<PageMemory> pieces_;
  std::size_t piece_used_ = 0;  ///< used bytes of pieces_.back()
  std::size_t held_ = 0;        ///< bytes of all pieces
  std::vector<std::byte*> free_;
  std::size_t taken_ = 0;
};

}  // namespace pointsweep
