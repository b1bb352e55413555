// SPDX-License-Identifier: MIT
/// Where points come from, without saying what a file is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Where points come from, without saying what a file is: `read(row, records)` as Reader::read.
struct PointSource {
  Schema schema;
  std::uint64_t count = 0;
  std::function<std::size_t(std::uint64_t row, std::span<std::byte> records)> read;
};

/// Fills `records` (whole ones) from `row` on, or throws Error if the source ends before.
void read_fully(const PointSource& source, std::uint64_t row, std::span<std::byte> records);

}  // namespace pointsweep
