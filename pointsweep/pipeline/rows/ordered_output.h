// SPDX-License-Identifier: MIT
/// Output in canonical order (along the axis; ties by x, y, z, then input row), slab by slab, and the places of the
/// points of a slab in this order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/order/row_store.h"
#include "pointsweep/order/source.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/pipeline/plan/output_layout.h"

namespace pointsweep {

/// Returns the indices of `records`, the working records of a slab, in canonical order.
std::vector<std::uint32_t> order_of(const Stream& stream, const std::vector<std::byte>& records);

/// Returns the inverse permutation of order_of(): the place of each record within the slab.
std::vector<std::uint32_t> ranks(const Stream& stream, const std::vector<std::byte>& records);

/// Passes the first `bytes` of every working record to `write` in canonical order, a slab at a time, then those of the
/// nonfinite points by ascending row, one at a time. The slabs must be in canonical order (StreamOptions::canonical).
/// After each slab, calls `report` with the number of points of the slabs written so far.
void write_in_order(const Stream& stream, std::size_t bytes,
                    const std::function<void(std::span<const std::byte>)>& write,
                    const std::function<void(std::uint64_t)>& report);

/// Sources of output records that a last phase puts in order (ChainPlan::reorders). Each record is followed by the
/// position that decides its place, as three numbers of type f64: the last attribute of `rows` if `by_moved_positions`,
/// otherwise the position in the input. The arguments must outlive this object.
class Reordering {
 public:
  Reordering(InputCloud& cloud, const RowFile& rows, const OutputLayout& layout, bool by_moved_positions);
  /// Returns only the positions, for the survey. This object must outlive the source.
  PointSource positions() const;
  /// Returns whole records with their positions. This object must outlive the source.
  PointSource records() const;

 private:
  class Rows;
  using Fill = std::function<void(Rows& rows, std::uint64_t row, std::size_t n, std::byte* out)>;
  PointSource source(Schema schema, const Fill& fill) const;

  PointSource input_;
  const RowFile& rows_;
  const OutputLayout& layout_;
  bool by_moved_positions_;
  PositionFields input_position_;
};

}  // namespace pointsweep
