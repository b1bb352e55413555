// SPDX-License-Identifier: MIT
/// The rows of an input that an output has, where a stage has left out some, and the comparison of all
/// points and attributes of two clouds; the random sample of the rows that a check evaluates.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/verify.h"
#include "pointsweep/verify/rows/field_pair.h"
#include "pointsweep/verify/rows/made_fields.h"
#include "pointsweep/verify/rows/row_source.h"

namespace pointsweep {

struct RowAlignment {
  std::vector<std::uint64_t> kept;            ///< row of the input of each row of the output; they ascend
  std::optional<std::uint64_t> not_of_input;  ///< the first row of the output that is not a later row of the input

  bool has(std::uint64_t row) const { return place_of(row).has_value(); }
  /// The row of the output.
  std::optional<std::uint64_t> place_of(std::uint64_t row) const;
};

/// Aligns an output whose rows are rows of the input, in the order of the input, with some left out: each row of the
/// output is taken for the first row of the input that has its values. `pairs`: the fields that are compared.
RowAlignment align_rows(RowSource& in, RowSource& out, std::span<const FieldPair> pairs, const PhaseProgress& progress);

/// A random sample of the rows of the input: half of them rows that the output has, if there are enough of both. In no
/// order.
std::vector<std::uint64_t> sample_of_both(const RowAlignment& alignment, std::uint64_t count, std::uint64_t size,
                                          std::uint64_t seed);

/// Returns the rows among `rows`, ascending, that have a twin: a row that differs from it less than the output can
/// hold, where the output has only one of the two, so that it does not tell which. Rows without a difference stay or go
/// together.
std::vector<std::uint64_t> rows_with_twins(RowSource& in, const RowAlignment& alignment,
                                           std::span<const FieldPair> pairs, std::span<const std::uint64_t> rows,
                                           const PhaseProgress& progress);

struct RowsWithValues {
  std::vector<std::uint64_t> rows;  ///< of the output
  bool are_unique = true;           ///< no other row of the output has the values of one of them
};

/// For each of `rows` of the input, which ascend, a row of the output that has its values in the fields of `pairs`, in
/// whatever order the output is; nothing if a row has none. Reads the output once.
std::optional<RowsWithValues> rows_with_values(RowSource& in, RowSource& out, std::span<const FieldPair> pairs,
                                               std::span<const std::uint64_t> rows, const PhaseProgress& progress);

/// The ways in which the output holds what the input has.
struct OutputWays {
  OwnField own_field = nullptr;      ///< of its format, which may leave out fields whose values are all 0
  std::optional<int> decimals = {};  ///< FileLayout::decimals
};

/// Reads both files once, side by side. `replaced[f]`: field f of the input was computed again and is not compared.
/// `look` is called with every row and position of the input.
Arrivals compare_arrivals(RowSource& in, RowSource& out, const std::vector<bool>& replaced, const OutputWays& ways,
                          const PhaseProgress& progress,
                          const std::function<void(std::uint64_t row, Vec3 position)>& look);

/// `size` different rows of 0 ... count - 1, ascending, every set of them equally likely; all rows if there are no
/// more. The same seed gives the same rows.
std::vector<std::uint64_t> sample_rows(std::uint64_t count, std::uint64_t size, std::uint64_t seed);

/// For each of `rows` of the input, which ascend, its row in canonical order along `axis`: by the coordinate on it,
/// ties by x, y, z, then row; points that are not finite last, by row. Reads the input once more and counts: O(n log
/// rows).
std::vector<std::uint64_t> sweep_rows(RowSource& in, std::span<const std::uint64_t> rows, int axis,
                                      const PhaseProgress& progress);

}  // namespace pointsweep
