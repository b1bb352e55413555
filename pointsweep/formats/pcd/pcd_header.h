// SPDX-License-Identifier: MIT
/// The header of a PCD file (Point Cloud Library, versions .5 to 0.7).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pointsweep/points/schema.h"
#include "pointsweep/reader.h"
#include "pointsweep/storage/local/input_file.h"

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
  std::string viewpoint;                ///< the unchanged line; "" if there is none
  std::vector<std::string> provenance;  ///< comments that say how the file was made
  PcdData data = PcdData::ascii;
  std::uint64_t body_offset = 0;  ///< byte after the header
  std::uint64_t body_line = 1;    ///< number of the line after the header, from 1

  /// Returns the fields as operators see them: without padding, and with packed colours as red, green, blue (and
  /// alpha).
  Schema schema() const;
};

/// The extras of a PCD file for a PCD output.
struct PcdExtras final : FormatExtras {
  static constexpr std::string_view kFormat = "pcd";
  std::string_view format() const override { return kFormat; }
  bool is_like(const FormatExtras& other) const override {
    return viewpoint == static_cast<const PcdExtras&>(other).viewpoint;
  }

  std::string viewpoint;  ///< PcdHeader::viewpoint if it is complete
};

/// Reads the header of a file. Throws Error for a header that is wrong or has no end.
PcdHeader read_pcd_header(const InputFile& file);

}  // namespace pointsweep
