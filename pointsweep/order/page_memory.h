// SPDX-License-Identifier: MIT
/// Large pieces of zeroed memory directly from the system, and blocks that are cut from such pieces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <utility>
#include <vector>

namespace pointsweep {

/// Zeroed memory whose pages take no physical memory until a thread touches them. The destructor returns the pages to
/// the system. Uses large pages, if any: first accesses take half the time in sequence, and far less at random.
class PageMemory {
 public:
  PageMemory() = default;
  /// Throws Error when the system refuses.
  explicit PageMemory(std::uint64_t bytes);
  ~PageMemory();
  PageMemory(PageMemory&& other) noexcept
      : address_(std::exchange(other.address_, nullptr)), bytes_(std::exchange(other.bytes_, 0)) {}
  PageMemory& operator=(PageMemory&& other) noexcept {
    std::swap(address_, other.address_);
    std::swap(bytes_, other.bytes_);
    return *this;
  }

  std::byte* data() const { return address_; }
  std::size_t size() const { return bytes_; }

 private:
  std::byte* address_ = nullptr;
  std::size_t bytes_ = 0;
};

/// A thread-safe pool of blocks of one size, cut from pieces of memory whose size grows with demand. The pool returns
/// memory to the system when it is cleared or destroyed, never block by block.
class BlockPool {
 public:
  explicit BlockPool(std::size_t block_bytes);

  /// Returns a block whose content is undefined. The pool owns the block.
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
