// SPDX-License-Identifier: MIT
/// PLY files ("The PLY Polygon File Format", Greg Turk, 1994): the header, comments with facts for which PLY has no
/// other place, a reader of ascii and binary files of either byte order, and a writer of binary little-endian files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/formats/crs.h"
#include "pointsweep/formats/las_scale.h"
#include "pointsweep/reader.h"
#include "pointsweep/storage/local/input_file.h"
#include "pointsweep/writer.h"

namespace pointsweep {

enum class PlyEncoding : std::uint8_t { ascii, little_endian, big_endian };

struct PlyProperty {
  std::string name;
  Type type = Type::f32;  ///< type of the value, or of the items of a list
  bool is_list = false;
  Type count_type = Type::u8;  ///< type of the count before the items of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;  ///< number of entries that the header states
  std::vector<PlyProperty> properties;

  bool has_list() const;
  /// Returns the bytes of one entry in a binary file. Must be called only if has_list() is false.
  std::uint32_t stride() const;
};

/// The lines of the header that start with `comment` or `obj_info`, in their order, except the lines that
/// take_crs_comments() and take_las_comment() remove. PLY outputs repeat the lines.
struct PlyExtras final : FormatExtras {
  static constexpr std::string_view kFormat = "ply";
  std::string_view format() const override { return kFormat; }
  bool is_like(const FormatExtras&) const override { return true; }  // the lines of the first input are kept

  std::vector<std::string> lines;
  std::vector<std::string> provenance;  ///< lines about how the file was made
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::vector<std::string> remarks;  ///< `comment` and `obj_info` lines
  std::uint64_t body_offset = 0;     ///< first byte after the header
  std::uint64_t body_line = 0;       ///< number, from 1, of the first line after the header
};

/// Reads the header of a file. Throws Error, which names the line, for a header that is invalid or longer than 1 MiB.
PlyHeader read_ply_header(const InputFile& file);

std::string_view name_of(PlyEncoding encoding);
/// Returns the name of a type in outputs.
std::string_view ply_name_of(Type type);

/// Returns lines that state the system. They begin with `comment` and have at most 1,000 bytes, since some programs
/// refuse lines of 1,024 bytes.
std::vector<std::string> crs_comments(const Crs& crs);

/// Returns the system that lines of crs_comments() state, and removes these lines from `lines`. Invalid lines are not
/// removed.
std::optional<Crs> take_crs_comments(std::vector<std::string>& lines);

/// Returns a line that begins with `comment` and states the meaning of the coordinates and times of a LAS file.
std::string las_comment(const LasOrigin& origin);
/// Returns the meaning that a line of las_comment() states, and removes the line. An invalid line is not removed.
std::optional<LasOrigin> take_las_comment(std::vector<std::string>& lines);

/// Opens a file. The points are the entries of the element `vertex`, with all properties. Other elements are skipped,
/// and those with entries are named in FileInfo::warnings, since an output does not keep them. Records of a binary file
/// are its bytes, in little-endian order. Throws Error for lists on vertices, missing x, y or z, and fewer vertices
/// than the header says.
std::unique_ptr<Reader> open_ply(const std::filesystem::path& path);

/// Creates a writer of one element `vertex` with a property for each component of each field, in the order of the plan.
/// Properties have the names of column_names() and the types of the fields. Scaled fields become `double`, bit fields
/// the smallest unsigned type that holds them. PLY has no 64-bit integers. If the first input is a PLY file, 64-bit
/// fields are written as the nonstandard types `int64` and `uint64`; otherwise they become `double`, and an integer
/// that a double cannot represent exactly is an Error. The coordinate reference system becomes comments: see
/// ply_comments.cpp.
std::unique_ptr<Writer> create_ply_writer(const OutputPlan& plan);

}  // namespace pointsweep
