// SPDX-License-Identifier: MIT
/// Large pieces of zeroed memory directly from the system.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace pointsweep {

/// Memory in pages, which cost nothing until they are touched, and which return to the system at once. Uses large
/// pages, which halve the cost of touching pages in sequence and save most of it for random access.
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

}  // namespace pointsweep
