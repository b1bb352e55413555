// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "pointsweep/points/schema.h"
#include "pointsweep/row_error.h"
#include "pointsweep/sweep/plan.h"

namespace pointsweep {

/// Fills `out` with the values of a file column, in the type that stages were promised, for records of `schema` whose
/// rows are `rows`. Notes in `refused` values that this type cannot hold.
void fill_file_column(const FileColumn& file, const Schema& schema, const std::byte* records,
                      std::span<const std::uint64_t> rows, std::byte* out, FirstRowError& refused);

}  // namespace pointsweep
