// SPDX-License-Identifier: MIT
/// The rows of a cloud that a picture is made of.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"

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

/// Returns the rows that can be read and drawn in about `seconds`: all rows, or every n-th stretch of rows. A stretch
/// is a chunk of the file, or 256 rows if the file has no chunks. Reads a few stretches to measure the time of one.
RowStretches rows_within(InputCloud& cloud, double seconds);

}  // namespace pointsweep
