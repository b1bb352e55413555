// SPDX-License-Identifier: MIT
/// The levels of detail that a picture shows.
#pragma once

#include "pointsweep/formats/cloud/input_cloud.h"

namespace pointsweep {

/// Returns the cloud with only as many levels of detail as are needed until the spacing of points is at most a pixel of
/// a picture of this size; all points unless all inputs have levels.
InputCloud drawn_levels(const InputCloud& cloud, unsigned pixels);

}  // namespace pointsweep
