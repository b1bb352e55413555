// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "pointsweep/points/schema.h"
#include "pointsweep/sweep/plan.h"

namespace pointsweep {

/// Fills `out` with the values of a file column for `size` records of `schema`, in the type that stages were promised.
void fill_file_column(const FileColumn& file, const Schema& schema, const std::byte* records, std::size_t size,
                      std::byte* out);

}  // namespace pointsweep
