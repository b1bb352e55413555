// SPDX-License-Identifier: MIT
/// E57 files (ASTM E2807): the scans that a file describes and the values of their points, through the codec (codecs/);
/// the representation of the attributes of a record; a reader; and a writer of files with one scan without a pose.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/points/schema.h"
#include "pointsweep/reader.h"
#include "pointsweep/storage/local/input_file.h"
#include "pointsweep/writer.h"

struct psc_e57;
struct psc_e57_reader;

namespace pointsweep {

struct E57Attribute {
  enum class Kind : std::uint8_t { single, real, scaled_integer, integer };
  std::string name;  ///< name in the file, e.g. "cartesianX"
  Kind kind = Kind::real;
  std::int64_t least = 0, most = 0;  ///< range of stored integers, before scale and offset
  double scale = 1, offset = 0;      ///< value = integer * scale + offset; 1 and 0 unless kind is scaled_integer

  bool is_stored_as_integer() const { return kind == Kind::scaled_integer || kind == Kind::integer; }
  /// Returns the value for a `stored` number that E57File::Points::read() returns.
  double value(std::uint64_t stored) const;
};

struct E57Scan {
  std::uint64_t points = 0;
  std::vector<E57Attribute> attributes;
  bool has_pose = false;
  std::array<double, 4> rotation{1, 0, 0, 0};  ///< unit quaternion w, x, y, z
  std::array<double, 3> translation{};
  std::string description = {};
};

class E57File {
 public:
  /// Throws Error if the file is damaged, or no codecs are built in.
  explicit E57File(const std::filesystem::path& path);

  const InputFile& file() const { return *file_; }
  const std::vector<E57Scan>& scans() const { return scans_; }
  std::size_t images() const { return images_; }
  const std::string& coordinate_system() const { return coordinate_system_; }  ///< WKT; empty if there is none

  /// A reader of the points of one scan, from the first to the last.
  class Points {
   public:
    Points(const E57File& file, std::size_t scan);
    ~Points();
    Points(const Points&) = delete;
    Points& operator=(const Points&) = delete;

    std::size_t scan() const { return scan_; }
    std::uint64_t next() const { return next_; }  ///< row in the scan of the next point
    /// Reads one number for each attribute of each point: a stored integer, or the bits of a double. The scan must have
    /// at least as many points left. Throws Error for a damaged file.
    void read(std::span<std::uint64_t> values);

   private:
    const E57File& file_;
    std::size_t scan_;
    std::uint64_t next_ = 0;
    psc_e57_reader* reader_ = nullptr;
  };

 private:
  std::unique_ptr<const InputFile> file_;
  std::shared_ptr<const psc_e57> codec_;
  std::vector<E57Scan> scans_;
  std::size_t images_ = 0;
  std::string coordinate_system_;
};

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
/// Returns a warning about the names of fields of `path` that E57 does not allow; empty if there are none.
std::string changed_e57_names(const std::filesystem::path& path, const Schema& schema);

/// Returns `name` with '_' instead of all characters except letters, digits, '-' and '_'. A name in kE57Names, or one
/// that XML does not allow, gets an '_' in front.
std::string e57_name(const std::string& name);

/// Opens a file. Coordinates are float64, Cartesian or converted from spherical coordinates, with the pose of the scan
/// applied to them and to normals. Other attributes have the library's names (kE57Names), or else their own; they are 0
/// in scans that lack them. `scan` is the number of the scan, from 0, unless the file has a single scan with an
/// attribute of that name. Points marked as invalid have NaN coordinates. Images are left out with a warning. Throws
/// Error for a damaged file, and if codecs are not built in.
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
