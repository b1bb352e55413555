// SPDX-License-Identifier: MIT
/// Whether every point and every attribute of the input is in the output.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/verify/row_source.h"

namespace pointsweep {

/// One attribute of the input, as the output's type holds it.
struct AttributeArrival {
  std::string name;
  std::uint64_t sum_in = 0, sum_out = 0;  ///< checksums that do not depend on the order of the points
  std::uint64_t rows_different = 0;       ///< rows whose values differ, row by row
  std::uint64_t first_different = 0;      ///< the first of them
  double expected = 0, found = 0;         ///< there
};

struct Arrivals {
  std::vector<AttributeArrival> attributes;
  std::vector<std::string> missing;  ///< attributes of the input that the output has not
  std::uint64_t points_in = 0, points_out = 0;
  std::uint64_t sum_in = 0, sum_out = 0;            ///< checksums of whole points, all attributes together
  std::uint64_t rows_different = 0;                 ///< rows of both whose points differ
  std::optional<std::uint64_t> first_different;     ///< row whose points differ; a row that only one file has counts
  std::array<bool, 3> ascending{true, true, true};  ///< the output, along x, y, z, with not finite points at its end
  Box bounds;                                       ///< of the finite points of the input
  std::uint64_t nonfinite = 0;                      ///< points of the input with NaN or infinite coordinates

  bool row_by_row() const { return missing.empty() && !first_different; }
  /// The same points with the same attributes, in any order.
  bool in_some_order() const { return missing.empty() && points_in == points_out && sum_in == sum_out; }
};

/// Reads both files once, side by side. `replaced[f]`: field f of the input was computed again and is not compared.
/// `look` is called with every row and position of the input.
Arrivals compare_arrivals(RowSource& in, RowSource& out, const std::vector<bool>& replaced,
                          const PhaseProgress& progress,
                          const std::function<void(std::uint64_t row, Vec3 position)>& look);

}  // namespace pointsweep
