// SPDX-License-Identifier: MIT
/// Writing points as text: .csv with commas, .xyz, .txt, .asc and .pts with spaces.
#pragma once

#include <memory>

#include "pointsweep/writer.h"

namespace pointsweep {

/// Every value in the fewest digits that give the same value of its type again. The names of the columns stand in the
/// first line: plain in a .csv, after `# ` otherwise, so that programs that know no header take it for a comment.
/// A .pts starts with the number of points instead, and names its columns only where they are not the usual ones.
std::unique_ptr<Writer> create_text_writer(const OutputPlan& plan);

}  // namespace pointsweep
