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
  /// Throws Error where the disk is full.
  virtual void append(std::span<const std::byte> bytes) = 0;
  /// Fills `bytes`, all of them appended before, from `offset` on.
  virtual void read(std::uint64_t offset, std::span<std::byte> bytes) const = 0;
  /// Writes over bytes that were appended before.
  virtual void replace(std::uint64_t offset, std::span<const std::byte> bytes) = 0;
};

/// Makes an empty one.
using MakeScratch = std::function<std::unique_ptr<Scratch>()>;

}  // namespace pointsweep
