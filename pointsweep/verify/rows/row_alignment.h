// SPDX-License-Identifier: MIT
/// The correspondence of the rows of an input and an output: rows that the output has kept, the comparison of all
/// points and attributes, and the random sample of rows for a check.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/verify.h"
#include "pointsweep/verify/rows/made_values.h"
#include "pointsweep/verify/rows/row_source.h"

namespace pointsweep {

struct RowAlignment {
  std::vector<std::uint64_t> kept;            ///< for each matched row of the output, its row in the input; ascending
  std::optional<std::uint64_t> not_of_input;  ///< the first row of the output without a match in the rest of the input

  bool has(std::uint64_t row) const { return place_of(row).has_value(); }
  /// Returns the row of the output that is row `row` of the input; none if it was dropped.
  std::optional<std::uint64_t> place_of(std::uint64_t row) const;
};

/// Aligns an output that has some of the rows of the input, in the order of the input. Each row of the output is
/// matched with the first remaining row of the input that has its values. `pairs`: the fields that are compared.
RowAlignment align_rows(RowSource& in, RowSource& out, FilePairs& pairs, const PhaseProgress& progress);

/// Returns a random sample of the rows of the input, in arbitrary order. Half of the sampled rows are in the output, if
/// enough rows are in the output and enough are not.
std::vector<std::uint64_t> sample_of_both(const RowAlignment& alignment, std::uint64_t count, std::uint64_t size,
                                          std::uint64_t seed);

/// Returns the rows among `rows`, ascending, that have an ambiguous twin: another row of the input with the same values
/// in the precision of the output, while the output has only one of the two. Exactly equal rows are no twins: they are
/// kept or dropped together.
std::vector<std::uint64_t> rows_with_twins(RowSource& in, const RowAlignment& alignment, FilePairs& pairs,
                                           std::span<const std::uint64_t> rows, const PhaseProgress& progress);

/// The rows of an output whose values equal those of one row of the input.
struct PossibleRows {
  std::vector<std::uint64_t> rows;  ///< at most kMostPossibleRows, ascending
  std::uint64_t count = 0;          ///< number of all such rows, which may exceed rows.size()
};
inline constexpr std::size_t kMostPossibleRows = 64;

/// Returns, for each of `rows` of the input, the rows of the output that have equal values in the fields of `pairs`;
/// nothing if the output lacks one of `rows`. `rows` ascend; the output may be in any order. Reads the output once.
std::optional<std::vector<PossibleRows>> rows_with_values(RowSource& in, RowSource& out, FilePairs& pairs,
                                                          std::span<const std::uint64_t> rows,
                                                          const PhaseProgress& progress);

/// The ways in which the output may store the input's values.
struct OutputWays {
  /// Format::own_field of the output's format. The output may lack a field of the format if all its values are 0.
  OwnField own_field = nullptr;
  StoredName stored_name = nullptr;  ///< names of the output's format
  StoredPlaces places = {};
  bool in_any_order = false;  ///< true if the order of the output's rows is unknown
};

/// Compares all values of both files, which are read once, at the same time. `replaced[f]`: true if field f of the
/// input is not compared, because it was computed again or not written. `look` is called with every row and position of
/// the input.
Arrivals compare_arrivals(RowSource& in, RowSource& out, const std::vector<bool>& replaced, const OutputWays& ways,
                          const PhaseProgress& progress,
                          const std::function<void(std::uint64_t row, Vec3 position)>& look);

/// Returns `size` different rows of 0 ... count - 1, ascending, or all rows if `count` is not larger. Every set of rows
/// has the same probability. Equal seeds give equal rows.
std::vector<std::uint64_t> sample_rows(std::uint64_t count, std::uint64_t size, std::uint64_t seed);

/// Returns, for each of `rows` of the input, its row in canonical order along `axis`: by the coordinate on the axis,
/// ties by x, y, z, then row; points that are not finite last, by row. `rows` ascend. Reads the input once more. Time:
/// O(n log m) for n points and m rows.
std::vector<std::uint64_t> sweep_rows(RowSource& in, std::span<const std::uint64_t> rows, int axis,
                                      const PhaseProgress& progress);

}  // namespace pointsweep
