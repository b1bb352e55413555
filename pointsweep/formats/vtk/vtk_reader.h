// SPDX-License-Identifier: MIT
/// Reading legacy VTK files: the points of POLYDATA, UNSTRUCTURED_GRID and STRUCTURED_GRID.
#pragma once

#include <filesystem>
#include <memory>

#include "pointsweep/reader.h"

namespace pointsweep {

/// Points with all their attributes: scalars, vectors, normals (nx ny nz), colours (red green blue alpha), texture
/// coordinates, tensors and arrays of fields, in the types of the file. Cells and their attributes are left out; a
/// warning counts them. Opening a text file reads it once. Throws Error for a damaged or truncated file.
std::unique_ptr<Reader> open_vtk(const std::filesystem::path& path);

}  // namespace pointsweep
