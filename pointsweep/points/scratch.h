// SPDX-License-Identifier: MIT
/// Bytes that an algorithm puts aside in the temporary folder: appended in sequence, then read from any place.
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
};

/// Makes an empty one.
using MakeScratch = std::function<std::unique_ptr<Scratch>()>;

}  // namespace pointsweep
