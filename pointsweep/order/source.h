// SPDX-License-Identifier: MIT
/// Sources of points, independent of files and formats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Fills `records` with rows from `row` on and returns the number of rows read, like Reader::read().
using ReadRows = std::function<std::size_t(std::uint64_t row, std::span<std::byte> records)>;

/// The rows of a cloud: their schema, their number, and functions that read them.
struct PointSource {
  Schema schema;
  std::uint64_t count = 0;
  ReadRows read;  ///< reads rows; called by one thread at a time
  /// Returns a function that reads rows for one thread, while other threads read with their own functions. It fills
  /// only the `wanted` fields, or all fields if `wanted` is empty. Returns an empty function if only one thread at a
  /// time can read.
  std::function<ReadRows(const std::vector<std::size_t>& wanted)> for_thread = {};
  /// Returns the end of the rows from `row` on that one thread should read, or `row` if the rows may be split anywhere.
  std::function<std::uint64_t(std::uint64_t row)> chunk_end = {};
};

/// Fills `records` (whole records) from `row` on. Throws Error if the source has fewer rows.
void read_fully(const PointSource& source, std::uint64_t row, std::span<std::byte> records);
/// Fills `records` (whole records) from `row` on with `read` instead of source.read. Throws Error if the source has
/// fewer rows.
void read_fully(const PointSource& source, const ReadRows& read, std::uint64_t row, std::span<std::byte> records);

}  // namespace pointsweep
