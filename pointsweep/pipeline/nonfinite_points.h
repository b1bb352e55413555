// SPDX-License-Identifier: MIT
/// Points without a place in space: they are in no slab, keep their attributes, and get the values that stand for none.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/order/stream.h"

namespace pointsweep {

/// Calls `use(i, record, row)` for the nonfinite points of the stream in ascending row, with their working records.
void for_each_nonfinite(const Stream& stream,
                        const std::function<void(std::uint64_t i, const std::byte* record, std::uint64_t row)>& use);

/// Numbers of the first of these rows, ascending, at most `most`.
std::vector<std::uint64_t> first_nonfinite_rows(const Stream& stream, std::size_t most);

/// The result records of such points.
class NonfiniteResult {
 public:
  NonfiniteResult(const std::vector<Attribute>& made, const Schema& working_record);
  /// Values of none, and where a position is made, the position of the point, which does not move. Valid until the next
  /// call.
  const std::vector<std::byte>& of(const std::byte* record);

 private:
  PositionFields position_;
  std::vector<std::byte> result_;
  std::vector<std::size_t> positions_;  ///< where in the result
};

}  // namespace pointsweep
