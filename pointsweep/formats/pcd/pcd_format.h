// SPDX-License-Identifier: MIT
/// Reading PCD files (Point Cloud Library), and writing them, version 0.7, binary.
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

/// All fields with their counts; a colour packed into `rgb` or `rgba` becomes red, green, blue (and alpha). Points
/// whose coordinates are NaN, as organised clouds have where the sensor saw nothing, are points. VIEWPOINT is not
/// applied; if it moves or turns the points a warning says so, another that the rows and columns of an organised cloud
/// are not kept. A decoder decompresses the wanted fields side by side, in about 70 KB for each field; the reader keeps
/// 8 KB of each field for every 16 MB of the widest. Opening a compressed file decompresses it once. Throws Error for a
/// damaged or truncated file.
std::unique_ptr<Reader> open_pcd(const std::filesystem::path& path);

/// All fields with their types; scaled ones as float64. 8-bit red, green and blue are packed into `rgb`, with alpha
/// into `rgba`, as PCL has them; wider colours stay fields of their own. Normals are normal_x, normal_y, normal_z.
/// VIEWPOINT is that of the inputs if they are PCD files and agree, and the identity otherwise.
std::unique_ptr<Writer> create_pcd_writer(const OutputPlan& plan);

/// The name under which a PCD file of ours holds a field: "normal_x" for nx.
std::string pcd_field_name(const std::string& name);

}  // namespace pointsweep
