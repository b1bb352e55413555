// SPDX-License-Identifier: MIT
/// One grid for the integer coordinates of inputs whose scales and offsets differ.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/formats/las_scale.h"
#include "pointsweep/reader.h"

namespace pointsweep {

/// Moves scaled 32-bit coordinates to another grid: raw = raw * factor + steps, nothing is rounded.
struct GridShift {
  std::array<std::uint32_t, 3> offsets{};  ///< of x, y and z in the record
  std::array<std::int64_t, 3> factors{1, 1, 1}, steps{};
  bool is_needed() const {
    return steps != std::array<std::int64_t, 3>{} || factors != std::array<std::int64_t, 3>{1, 1, 1};
  }
  /// Throws Error naming `path` if a coordinate leaves the 32 bits.
  void run(std::span<std::byte> records, std::size_t stride, const std::filesystem::path& path) const;
};

struct CommonGrid {
  LasQuantization grid;
  std::vector<GridShift> shifts;  ///< one for each input
};

/// The grid of the finest scale on which every coordinate of every input lies, if there is one: all x, y and z are
/// scaled int32, each scale is a whole multiple of the finest, offsets differ by whole steps of it, and the bounds in
/// the headers stay within 32 bits. The offset of each axis is that of the first input for which all this holds, or
/// else whole steps away from the first input's, in the middle of all bounds.
std::optional<CommonGrid> common_grid(const std::vector<std::unique_ptr<Reader>>& readers);

}  // namespace pointsweep
