// SPDX-License-Identifier: MIT
/// Sources of points, independent of files and formats, and readers of their rows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pointsweep/geometry.h"
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

/// Returns the indices of the fields x, y and z.
std::vector<std::size_t> position_columns(const Schema& schema);

/// A reader of blocks of rows for one thread, which also decodes their positions. Other threads may read at the same
/// time.
class BlockReader {
 public:
  /// `wanted`: the required fields; empty: all. The source must outlive the reader and have for_thread().
  BlockReader(const PointSource& source, const std::vector<std::size_t>& wanted);

  /// Reads `rows` rows from `first_row` on. Throws Error if the source has fewer rows.
  void read(std::uint64_t first_row, std::size_t rows);

  /// Returns the number of rows of the last read().
  std::size_t count() const { return count_; }
  Vec3 position(std::size_t i) const { return {numbers_[i], numbers_[count_ + i], numbers_[2 * count_ + i]}; }
  const std::byte* records() const { return records_.data(); }

 private:
  const PointSource& source_;
  PositionFields fields_;
  ReadRows read_;
  std::size_t count_ = 0;
  std::vector<std::byte> records_;
  std::vector<double> numbers_;  ///< x, then y, then z
};

}  // namespace pointsweep
