// SPDX-License-Identifier: MIT
/// Reading E57 (ASTM E2807): all scans of a file as one cloud, in the coordinates of the file.
#pragma once

#include <filesystem>
#include <memory>

#include "pointsweep/reader.h"

namespace pointsweep {

/// Cartesian coordinates, or those of spherical ones, with the pose of the scan applied to them and to normals, as
/// float64; all other attributes under the library's names, those that only some scans have 0 in the others; the number
/// of the scan, from 0, as `scan`, unless a single scan has an attribute of that name. A point that the file calls
/// invalid has NaN coordinates. Images are left out with a warning. Throws Error for a damaged file, and where codecs
/// are not built in.
std::unique_ptr<Reader> open_e57(const std::filesystem::path& path);

}  // namespace pointsweep
