// SPDX-License-Identifier: MIT
/// Bytes that an algorithm puts aside: appended in sequence, then read from any place.
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
