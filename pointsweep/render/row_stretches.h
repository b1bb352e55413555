// SPDX-License-Identifier: MIT
/// Which rows of a cloud a picture is made of.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/formats/input_cloud.h"

namespace pointsweep {

/// Rows that are read one after another.
struct RowStretch {
  std::uint64_t begin, end;
};

struct RowStretches {
  std::vector<RowStretch> stretches;  ///< ascending
  std::uint64_t count = 0;            ///< rows in all of them
};

RowStretches all_rows(const InputCloud& cloud);

/// As many rows as can be looked at and drawn in about so many seconds: all, or every n-th stretch of them, which is a
/// chunk where the file has chunks, else 256 rows. Reads a few stretches to find out how long one takes.
RowStretches rows_within(InputCloud& cloud, double seconds);

}  // namespace pointsweep
