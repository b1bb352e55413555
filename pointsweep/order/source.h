// SPDX-License-Identifier: MIT
/// Where points come from, without saying what a file is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Fills records with rows from `row` on and returns how many, as Reader::read.
using ReadRows = std::function<std::size_t(std::uint64_t row, std::span<std::byte> records)>;

/// Where points come from, without saying what a file is.
struct PointSource {
  Schema schema;
  std::uint64_t count = 0;
  ReadRows read;  ///< for one thread at a time
  /// Gives a function for one thread, beside which others may read with theirs; it fills only the `wanted` fields, or
  /// all if none is named. Empty functions where rows can only be read by one thread at a time.
  std::function<ReadRows(const std::vector<std::size_t>& wanted)> for_thread = {};
  /// The row behind the rows from `row` on that one thread should read, or `row` where that does not matter.
  std::function<std::uint64_t(std::uint64_t row)> chunk_end = {};
};

/// Fills `records` (whole ones) from `row` on, or throws Error if the source ends before.
void read_fully(const PointSource& source, std::uint64_t row, std::span<std::byte> records);
/// The same with `read` in the place of source.read.
void read_fully(const PointSource& source, const ReadRows& read, std::uint64_t row, std::span<std::byte> records);

}  // namespace pointsweep
