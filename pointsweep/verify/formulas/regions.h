// SPDX-License-Identifier: MIT
/// What is inside for crop, from its definition.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace pointsweep::formulas {

using Corner = std::array<double, 2>;
/// Rings without the repeated first corner.
using PolygonRings = std::vector<std::vector<Corner>>;

/// Whether the first `bounds.size()` / 2 coordinates of p lie between the two corners of the box, or on its faces.
bool is_in_box(const std::array<double, 3>& p, std::span<const double> bounds);

/// Whether p lies in one of the polygons, by the even-odd rule, or on an edge. Exact unless magnitudes of coordinates
/// differ by more than 2^400. Looks at every edge.
bool is_in_polygons(const Corner& p, std::span<const PolygonRings> polygons);

}  // namespace pointsweep::formulas
