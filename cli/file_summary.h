// SPDX-License-Identifier: MIT
/// What a look at every point of a file tells.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "pointsweep/formats/reader.h"
#include "pointsweep/math/box.h"

namespace pointsweep {

struct FileSummary {
  Box bounds;                                       ///< of the finite points
  std::uint64_t nonfinite = 0;                      ///< points with a NaN or infinite coordinate
  std::array<bool, 3> ascending{true, true, true};  ///< no finite point lies below the one before it along x, y, z
  std::array<bool, 3> descending{true, true, true};
};

/// Reads all points in sequence, in pieces; calls `progress(done, total)` after each.
FileSummary summarize(Reader& reader, const std::function<void(std::uint64_t done, std::uint64_t total)>& progress);

/// Several lines for people.
std::string to_text(const FileInfo& info, const FileSummary& summary);
/// The lines on points and bounds alone.
std::string to_text(std::uint64_t points, const Box& bounds);

}  // namespace pointsweep
