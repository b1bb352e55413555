// SPDX-License-Identifier: MIT
/// Which rows of an input an output has, where a stage has left out some.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/verify/field_pair.h"
#include "pointsweep/verify/row_source.h"

namespace pointsweep {

struct RowAlignment {
  std::vector<std::uint64_t> kept;            ///< row of the input of each row of the output; they ascend
  std::optional<std::uint64_t> not_of_input;  ///< the first row of the output that is not a later row of the input

  bool has(std::uint64_t row) const { return place_of(row).has_value(); }
  /// The row of the output.
  std::optional<std::uint64_t> place_of(std::uint64_t row) const;
};

/// Rows of the output are those of the input in its order, without some: each is the first that has its values.
/// `pairs`: what is compared. Of rows that are equal the first ones are taken.
RowAlignment align_rows(RowSource& in, RowSource& out, std::span<const FieldPair> pairs, const PhaseProgress& progress);

/// A random sample of the rows of the input: half of them rows that the output has, if there are enough of both. In no
/// order.
std::vector<std::uint64_t> sample_of_both(const RowAlignment& alignment, std::uint64_t count, std::uint64_t size,
                                          std::uint64_t seed);

/// Of some rows of the input, ascending: those that have a twin, a row that differs from it less than the output can
/// hold, and that the output has where it has not this one, or the other way round: it does not tell which of the two
/// it has. Rows without a difference stay or go together.
std::vector<std::uint64_t> rows_with_twins(RowSource& in, const RowAlignment& alignment,
                                           std::span<const FieldPair> pairs, std::span<const std::uint64_t> rows,
                                           const PhaseProgress& progress);

}  // namespace pointsweep
