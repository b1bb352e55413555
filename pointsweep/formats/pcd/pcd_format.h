// SPDX-License-Identifier: MIT
/// A reader of PCD files (Point Cloud Library), and a writer of binary files of version 0.7.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "pointsweep/reader.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Returns whether a file that begins with `head` is a PCD file.
bool starts_as_pcd(std::string_view head);

/// Opens a file with all fields and their counts. A colour packed into `rgb` or `rgba` becomes red, green, blue (and
/// alpha). Points with NaN coordinates, which organised clouds have where the sensor saw nothing, are kept. VIEWPOINT
/// is not applied; a warning is given if it is not the identity, and another if the rows and columns of an organised
/// cloud are lost. A decoder decompresses all wanted fields at the same time, with about 70 KB for each field; the
/// reader keeps 8 KB of each field for every 16 MB of the widest field. Opening a compressed file decompresses it once.
/// Throws Error for a damaged or truncated file.
std::unique_ptr<Reader> open_pcd(const std::filesystem::path& path);

/// Creates a writer of all fields with their types; scaled fields become float64. 8-bit red, green and blue are packed
/// into `rgb`, with alpha into `rgba`, as in PCL; wider colours stay separate fields. Normals are normal_x, normal_y,
/// normal_z. VIEWPOINT is copied from the inputs if all of them are PCD files and agree; otherwise it is the identity.
std::unique_ptr<Writer> create_pcd_writer(const OutputPlan& plan);

/// Returns the name in PCD outputs of a field that is not part of a packed colour: "normal_x" for nx, and likewise for
/// ny and nz; other names stay unchanged.
std::string pcd_field_name(const std::string& name);

}  // namespace pointsweep
