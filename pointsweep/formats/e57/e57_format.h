// SPDX-License-Identifier: MIT
/// A reader of E57 files (ASTM E2807), and a writer of files with one scan without a pose.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "pointsweep/reader.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Opens a file. Coordinates are float64, Cartesian or converted from spherical ones, with the pose of the scan applied
/// to them and to normals. Other attributes have the library's names; they are 0 in scans that lack them. `scan` is the
/// number of the scan, from 0, unless the file has a single scan with an attribute of that name. Points marked as
/// invalid have NaN coordinates. Images are left out with a warning. Throws Error for a damaged file, and if codecs are
/// not built in.
std::unique_ptr<Reader> open_e57(const std::filesystem::path& path);

/// Creates a writer. Coordinates have the type of the input; integers of a LAS grid become scaled integers. A point
/// with a coordinate that is not finite is marked as invalid, and reads as NaN. Attributes of the standard have the
/// names of the standard, normals have the names of the extension for surface normals, and all others have the name
/// `ps:NAME`. Throws Error if codecs are not built in. Writer::write() throws Error for an unsigned integer above
/// 2^63 - 1.
std::unique_ptr<Writer> create_e57_writer(const OutputPlan& plan);

/// Returns the bytes of memory that encoding takes, which depend neither on the records nor on the threads.
std::uint64_t e57_encoder_bytes(std::uint64_t record_bytes, unsigned threads);

}  // namespace pointsweep
