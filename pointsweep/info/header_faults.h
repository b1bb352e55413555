// SPDX-License-Identifier: MIT
/// Comparison of a header, and of attributes such as return numbers, with the points of the file.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/info.h"

namespace pointsweep {

/// A sentence for each axis whose bounds the header states wrongly, by more than half a step of stored coordinates; for
/// counts of points by return; and for points whose return number is above their number of returns.
std::vector<std::string> header_faults(const FileSummary& summary);

}  // namespace pointsweep
