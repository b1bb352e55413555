// SPDX-License-Identifier: MIT
/// A reader of PLY files, ascii and binary of either byte order, and a writer of binary little-endian files.
#pragma once

#include <filesystem>
#include <memory>

#include "pointsweep/reader.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Opens a file. The points are the entries of the element `vertex`, with all properties. Other elements are skipped
/// and named in FileInfo::warnings, since an output does not keep them. Records of a binary file are its bytes, in
/// little-endian order. Throws Error for lists on vertices, missing x, y or z, and fewer vertices than the header says.
std::unique_ptr<Reader> open_ply(const std::filesystem::path& path);

/// Creates a writer of one element `vertex` with a property for each component of each field, in the order of the plan.
/// Properties have the names of column_names() and the types of the fields. Scaled fields become `double`, bit fields
/// the smallest unsigned type that holds them. PLY has no 64-bit integers. If the first input is a PLY file, they are
/// written as the nonstandard types `int64` and `uint64`; otherwise they become `double`, and an integer that a double
/// cannot represent exactly is an Error. The coordinate reference system becomes comments: see ply_comments.cpp.
std::unique_ptr<Writer> create_ply_writer(const OutputPlan& plan);

}  // namespace pointsweep
