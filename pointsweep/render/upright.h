// SPDX-License-Identifier: MIT
/// The view of a cloud when the user names none: the direction that is up, and the side from which the cloud shows
/// most.
#pragma once

#include <span>

#include "pointsweep/geometry.h"
#include "pointsweep/render/view.h"

namespace pointsweep {

/// True if the cloud's extent along `up` is at most a quarter of the geometric mean of the two others, as in airborne
/// scans and reliefs. Extents leave out 0.1 % of the points at either end.
bool is_flat(std::span<const Vec3> sample, Up up);

/// The direction that points up in a cloud of unknown origin. A flat cloud: the positive axis across it. Else the cloud
/// stands on the side where the outermost 2 % of its extent cover most of that side (the area of their convex hull over
/// the area of the bounding rectangle): objects stand on a base or on feet, rooms and streets on a floor. z counts 1.25
/// times, so that it wins where sides are alike, and it wins where no side reaches a quarter. Cost: a sort of the
/// sample along each axis.
Up find_up(std::span<const Vec3> sample);

}  // namespace pointsweep
