// SPDX-License-Identifier: MIT
/// The meaning of the codes of a QSplat node: a sphere inside its parent's, a normal, a colour (Rusinkiewicz and Levoy,
/// "QSplat", SIGGRAPH 2000, Sections 3.1 and 3.2; the tables are those of the released program, file version 11).
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace pointsweep {

struct QsplatSphere {
  float x = 0, y = 0, z = 0, radius = 0;
};

/// Codes of spheres that the format knows; 13 bits hold 8192.
constexpr unsigned kQsplatSphereCodes = 7621;

/// The sphere with the 13-bit `code` inside `parent`: radius is the parent's times s/13, centre is the parent's plus
/// its radius times (s + 2x)/13 - 1 in each axis, where (s, x, y, z) is the code-th quadruple of 1 <= s <= 13, 0 <= x,
/// y, z <= 13 - s that fits (the cube of the child meets the parent's sphere). In single precision, as QSplat evaluates
/// it. Empty for a code that means nothing.
std::optional<QsplatSphere> qsplat_sphere(unsigned code, const QsplatSphere& parent);

/// The unit normal with the 14-bit `code`, which names one of 52×52 places on a face of a cube. (0, 0, 0) for the codes
/// of corners that lie outside of the unit sphere, which no encoder gives; (0, 0, 1) for those without a face, as
/// QSplat.
std::array<float, 3> qsplat_normal(unsigned code);

/// Red, green and blue, 0 to 255, from 5, 6 and 5 bits.
std::array<std::uint8_t, 3> qsplat_color(unsigned code);

}  // namespace pointsweep
