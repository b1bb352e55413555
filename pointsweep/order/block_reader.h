// SPDX-License-Identifier: MIT
/// A reader of blocks of rows for one thread, which also decodes their positions. Other threads may read at the same
/// time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/order/source.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Returns the indices of the fields x, y and z.
std::vector<std::size_t> position_columns(const Schema& schema);

class BlockReader {
 public:
  /// `wanted`: the required fields; empty: all. The source must outlive the reader and have for_thread().
  BlockReader(const PointSource& source, const std::vector<std::size_t>& wanted);

  /// Reads `rows` rows from `first_row` on. Throws Error if the source has fewer rows.
  void read(std::uint64_t first_row, std::size_t rows);

  // Returns the number of rows of the last read().
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
