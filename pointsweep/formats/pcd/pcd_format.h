// SPDX-License-Identifier: MIT
/// PCD files (Point Cloud Library): the header of versions .5 to 0.7, a reader, and a writer of binary files of version
/// 0.7.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/points/schema.h"
#include "pointsweep/reader.h"
#include "pointsweep/storage/local/input_file.h"
#include "pointsweep/writer.h"

namespace pointsweep {

enum class PcdData : std::uint8_t { ascii, binary, binary_compressed };

/// A field in the file: `count` values of `type`.
struct PcdField {
  std::string name;
  Type type;
  std::uint32_t count;
  std::uint32_t offset;  ///< offset in a record of the binary encodings
  std::uint32_t bytes() const { return count * static_cast<std::uint32_t>(size_of(type)); }
};

struct PcdHeader {
  std::vector<PcdField> fields;  ///< padding, which is called `_`, included
  std::uint32_t stride = 0;      ///< bytes of a record
  std::uint64_t width = 0, height = 1, points = 0;
  std::string viewpoint;                ///< the unchanged line VIEWPOINT; "" if there is none
  std::vector<std::string> provenance;  ///< comment lines of the header with the record of the run (provenance.h)
  PcdData data = PcdData::ascii;
  std::uint64_t body_offset = 0;  ///< byte after the header
  std::uint64_t body_line = 1;    ///< number of the line after the header, from 1

  /// Returns the fields of the points that the reader returns: without padding, and with packed colours as red, green,
  /// blue (and alpha).
  Schema schema() const;
};

/// The extras of a PCD file for a PCD output.
struct PcdExtras final : FormatExtras {
  static constexpr std::string_view kFormat = "pcd";
  std::string_view format() const override { return kFormat; }
  bool is_like(const FormatExtras& other) const override {
    return viewpoint == static_cast<const PcdExtras&>(other).viewpoint;
  }

  std::string viewpoint;  ///< PcdHeader::viewpoint if that line has all of its numbers, else empty
};

/// Reads the header of a file. Throws Error for a header that is wrong or has no end.
PcdHeader read_pcd_header(const InputFile& file);

/// Returns whether a file that begins with `head` is a PCD file.
bool starts_as_pcd(std::string_view head);

/// Opens a file with all fields except padding, and their counts. A colour packed into `rgb` or `rgba` becomes red,
/// green, blue (and alpha). Points with NaN coordinates, which organised clouds have where the sensor saw nothing, are
/// kept. VIEWPOINT is not applied; a warning is given if it is not the identity, and another if the rows and columns of
/// an organised cloud are lost. A decoder of a compressed file decompresses all wanted fields at the same time, with
/// about 70 KB for each field; its reader keeps 8 KB of each field for every 16 MB of the widest field. Opening a
/// compressed file decompresses it once. Throws Error for a damaged or truncated file.
std::unique_ptr<Reader> open_pcd(const std::filesystem::path& path);

/// Creates a writer of all fields with their types; scaled fields become float64. 8-bit red, green and blue are packed
/// into `rgb`, with alpha into `rgba`, as in PCL; wider colours stay separate fields. Normals are normal_x, normal_y,
/// normal_z. VIEWPOINT is copied from the inputs if all of them are PCD files and agree; otherwise it is the identity.
std::unique_ptr<Writer> create_pcd_writer(const OutputPlan& plan);

/// Returns the name in PCD outputs of a field that is not part of a packed colour: "normal_x" for nx, and likewise for
/// ny and nz; other names stay unchanged.
std::string pcd_field_name(const std::string& name);

}  // namespace pointsweep
