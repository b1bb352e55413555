// SPDX-License-Identifier: MIT
/// Output in canonical order, slab by slab.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "pointsweep/order/stream.h"
#include "pointsweep/pipeline/output_set.h"
#include "pointsweep/pipeline/updated_cloud.h"

namespace pointsweep {

/// Gives the first `bytes` of every working record to `write`, points without a place last.
/// `report(points_written)` after each slab.
void write_in_order(const Stream& stream, std::size_t bytes,
                    const std::function<void(std::span<const std::byte>)>& write,
                    const std::function<void(std::uint64_t)>& report);

/// Output records in the order of positions that no sweep went by: each is followed by the position that gives it its
/// place, the one carried last in `rows` if `by_moved_positions`, otherwise the input's.
class Reordering {
 public:
  Reordering(InputCloud& cloud, const RowFile& rows, const OutputLayout& layout, bool by_moved_positions);
  /// Positions alone, for the survey.
  PointSource positions();
  /// Whole records.
  PointSource records();

 private:
  void read_inputs(std::uint64_t row, std::size_t n);
  void put_positions(std::size_t n, std::size_t stride, std::byte* to);

  InputCloud& cloud_;
  const RowFile& rows_;
  const OutputLayout& layout_;
  bool by_moved_positions_;
  PositionFields input_position_;
  std::vector<std::byte> inputs_, carried_;
};

}  // namespace pointsweep
