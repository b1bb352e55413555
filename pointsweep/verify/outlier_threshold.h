// SPDX-License-Identifier: MIT
/// From which mean distance on points of an output are outliers.
#pragma once

#include <string>

#include "pointsweep/formats/reader.h"
#include "pointsweep/verify/row_source.h"
#include "pointsweep/verify/stage_formula.h"

namespace pointsweep {

/// mean + multiplier * deviation (n - 1) of the finite values of the field `name` of all points of `out`, in extended
/// precision. NaN if the output does not have the field. Reads it twice.
CloudThreshold outlier_threshold(Reader& out, const std::string& name, double multiplier,
                                 const PhaseProgress& progress);

}  // namespace pointsweep
