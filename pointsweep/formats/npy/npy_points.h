// SPDX-License-Identifier: MIT
/// NumPy arrays of points: .npy files, and .npz archives whose members are stored.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "pointsweep/reader.h"

namespace pointsweep {

/// Returns whether a file that begins with `head` is a NumPy array or an archive of NumPy arrays.
bool starts_as_npy_points(std::string_view head);

/// An array of n rows and three columns or more (x, y, z, then as default_column_names() says), in C or Fortran order,
/// or of a structured type with fields x, y, z (or xyz, ... of three values), in either byte order; values keep their
/// type. More axes, as of an organised cloud, are flattened, with a warning. In an archive the positions are the member
/// xyz, points, position(s), vertices or coordinates, or members x, y and z, or the only one that can be; members of as
/// many rows become attributes under their names, others are left out with a warning. Throws Error for anything else.
std::unique_ptr<Reader> open_npy_points(const std::filesystem::path& path);

}  // namespace pointsweep
