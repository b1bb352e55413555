// SPDX-License-Identifier: MIT
/// A Scratch that stores its bytes in a vector.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/points/scratch.h"

namespace pointsweep {

class ScratchInMemory final : public Scratch {
 public:
  void append(std::span<const std::byte> bytes) override { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  void read(std::uint64_t offset, std::span<std::byte> bytes) const override {
    ASSERT_LE(offset + bytes.size(), bytes_.size());
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset), bytes.size(), bytes.begin());
  }
  void replace(std::uint64_t offset, std::span<const std::byte> bytes) override {
    ASSERT_LE(offset + bytes.size(), bytes_.size());
    std::copy(bytes.begin(), bytes.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(offset));
  }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace pointsweep
