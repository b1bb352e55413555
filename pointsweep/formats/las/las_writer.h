// SPDX-License-Identifier: MIT
/// Writing LAS: a LAS input keeps all it has, anything else becomes LAS 1.4 (see las_layout.h).
#pragma once

#include <memory>

#include "pointsweep/writer.h"

namespace pointsweep {

/// Throws Error before anything is written when the points cannot be stored as LAS. Without a LAS input, plan.bounds
/// has to be there unless the coordinates are integers of at most 32 bits.
std::unique_ptr<Writer> create_las_writer(const OutputPlan& plan);

}  // namespace pointsweep
