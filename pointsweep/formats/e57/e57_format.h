// SPDX-License-Identifier: MIT
/// E57 files (ASTM E2807): the representation of the attributes of a record, a reader, and a writer of files with one
/// scan without a pose.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/formats/e57/e57_file.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/reader.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// The name of an attribute in the library and in E57.
struct E57Name {
  std::string_view ours, theirs;
  std::string_view extension = "";  ///< extension that defines the name; empty for the standard
};

/// The attributes that E57 or its extension names, the coordinates first.
inline constexpr E57Name kE57Names[] = {
    {"x", "cartesianX"},
    {"y", "cartesianY"},
    {"z", "cartesianZ"},
    {"invalid_state", "cartesianInvalidState"},
    {"range", "sphericalRange"},
    {"azimuth", "sphericalAzimuth"},
    {"elevation", "sphericalElevation"},
    {"spherical_invalid_state", "sphericalInvalidState"},
    {"intensity", "intensity"},
    {"intensity_invalid", "isIntensityInvalid"},
    {"red", "colorRed"},
    {"green", "colorGreen"},
    {"blue", "colorBlue"},
    {"color_invalid", "isColorInvalid"},
    {"row", "rowIndex"},
    {"column", "columnIndex"},
    {"return_index", "returnIndex"},
    {"return_count", "returnCount"},
    {"time_stamp", "timeStamp"},
    {"time_stamp_invalid", "isTimeStampInvalid"},
    {"nx", "normalX", "nor"},
    {"ny", "normalY", "nor"},
    {"nz", "normalZ", "nor"},
};

/// Number of the Cartesian coordinates at the beginning of kE57Names.
inline constexpr std::size_t kE57Coordinates = 3;

/// One value of a point: an attribute of the file, and its place in a record.
struct E57Column {
  E57Attribute attribute;  ///< its name is, for example, "cartesianX", or "nor:normalX" with an extension's prefix
  Field field;             ///< place of the value in a record; has one component

  /// Returns the number that the file stores: an integer without its scale, or the bits of a double.
  std::uint64_t stored(const std::byte* record) const;
};

/// Returns the columns for records of `schema`, the coordinates first, without `invalid_state`.
std::vector<E57Column> e57_columns(const Schema& schema);

/// Returns `name` with '_' instead of all characters except letters, digits, '-' and '_'. A name of the standard, or
/// one that XML does not allow, gets an '_' in front.
std::string e57_name(const std::string& name);

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
