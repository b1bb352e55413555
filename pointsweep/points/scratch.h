// SPDX-License-Identifier: MIT
/// Temporary storage of an algorithm: bytes are appended in sequence, and later read at any offset.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

namespace pointsweep {

class Scratch {
 public:
  virtual ~Scratch() = default;
  /// Appends bytes. Throws Error if the disk is full.
  virtual void append(std::span<const std::byte> bytes) = 0;
  /// Reads the stored bytes from `offset` on into `bytes`.
  virtual void read(std::uint64_t offset, std::span<std::byte> bytes) const = 0;
  /// Overwrites the stored bytes from `offset` on with `bytes`.
  virtual void replace(std::uint64_t offset, std::span<const std::byte> bytes) = 0;
};

/// A function that makes an empty Scratch.
using MakeScratch = std::function<std::unique_ptr<Scratch>()>;

}  // namespace pointsweep
