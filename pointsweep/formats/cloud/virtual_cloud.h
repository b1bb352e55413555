// SPDX-License-Identifier: MIT
/// Virtual point clouds: .vpc files, which name the point files of a data set. They are STAC feature collections
/// (https://github.com/PDAL/wrench/blob/main/vpc-spec.md), as PDAL wrench and QGIS write them.
#pragma once

#include <filesystem>
#include <vector>

#include "pointsweep/files.h"

namespace pointsweep {

/// By its extension, .vpc.
bool is_virtual_cloud(const std::filesystem::path& path);

/// The asset "data" of each feature, or else its first asset with the role "data", in the order of the file. Relative
/// names begin at the folder of the .vpc file. Throws Error for a file that is none, for addresses in the network, and
/// for files that do not exist.
std::vector<ListedFile> files_of_virtual_cloud(const std::filesystem::path& path);

}  // namespace pointsweep
