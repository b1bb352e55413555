// SPDX-License-Identifier: MIT
/// One schema for inputs that differ.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/formats/reader.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Moves scaled 32-bit coordinates to the grid of another file of the same scale: raw += steps, nothing is rounded.
struct GridShift {
  std::array<std::uint32_t, 3> offsets{};  ///< of x, y and z in the record
  std::array<std::int64_t, 3> steps{};
  bool is_needed() const { return steps != std::array<std::int64_t, 3>{}; }
  /// Throws Error naming `path` if a coordinate leaves the 32 bits.
  void run(std::span<std::byte> records, std::size_t stride, const std::filesystem::path& path) const;
};

/// How the records of one input become those of the cloud: shifted, then converted.
struct InputMapping {
  GridShift shift;
  std::unique_ptr<RecordConversion> conversion;  ///< null where the layout is the same
};

struct CommonSchema {
  Schema schema;
  std::vector<InputMapping> mappings;  ///< one for each input
};

/// As class Cloud documents it. Names that mean the same (`nx`, `NormalX`) are one field, under the first one's name.
CommonSchema common_schema(const std::vector<std::unique_ptr<Reader>>& readers);

}  // namespace pointsweep
