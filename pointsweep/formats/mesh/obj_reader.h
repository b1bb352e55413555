// SPDX-License-Identifier: MIT
/// Reading the vertices of OBJ files (Wavefront).
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "pointsweep/reader.h"

namespace pointsweep {

/// Returns whether the first line that is no comment is a line of an OBJ file: v, vn, vt, mtllib, o, g, s or usemtl.
bool starts_as_obj(std::string_view head);

/// The lines "v x y z", followed by a weight, which is left out, or a colour. Normals ("vn") are read where there are
/// as many as vertices, the first for the first; otherwise faces say which belong together, and they are left out with
/// a warning, as faces and other elements are.
std::unique_ptr<Reader> open_obj(const std::filesystem::path& path);

}  // namespace pointsweep
