// SPDX-License-Identifier: MIT
/// The layout of a LAS output, decided before the first record: the header, VLRs, the place of each value, and the
/// pieces of the input that are copied.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/formats/las/las_extra_bytes.h"
#include "pointsweep/formats/las/las_header.h"
#include "pointsweep/formats/las/las_point_formats.h"
#include "pointsweep/formats/las/las_reader.h"
#include "pointsweep/formats/las/laz_codec.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Bytes [begin, end) of the input, copied unchanged.
struct LasPiece {
  std::uint64_t begin = 0, end = 0;
  std::uint64_t size() const { return end - begin; }
};

/// The way in which a file stores its points. `nodes`: compressed, one chunk for each node of an octree (COPC).
enum class LasPoints { plain, compressed, nodes };

/// A LAS file in this order: header, `first_vlrs`, pieces `before` of the input, `added_vlrs`, pieces `between`,
/// `provenance_vlrs`, piece `after`, points, pieces `tail`. VLRs that describe the compression or the octree of the
/// input, and VLRs that `added_vlrs` replace, are left out.
struct LasLayout {
  LasHeader header;                        ///< the header without counts and bounds
  std::shared_ptr<const InputFile> input;  ///< null if the first input is not LAS
  std::vector<LasPiece> before, between;
  LasPiece after;
  std::vector<LasPiece> tail;
  std::vector<std::byte> first_vlrs;       ///< the COPC VLR with its header; its content is written after the points
  std::vector<std::byte> added_vlrs;       ///< VLRs with their headers; empty if the input's pieces contain all VLRs
  std::vector<std::byte> provenance_vlrs;  ///< new VLRs with their headers; old VLRs are in the pieces of the input
  std::vector<std::string> warnings;       ///< about properties of the cloud that the file cannot hold
  std::optional<LazLayout> laz;            ///< set if points are compressed

  /// Two schemas of equally many fields: field i of the incoming records is stored in field i of the file's records.
  Schema from, to;
  Field x, y, z;                  ///< the coordinates, as fields of `from`
  bool positions_change = false;  ///< coordinates are rounded to the grid, which must reach them
  bool points_moved = false;      ///< stages of the run changed the coordinates
  bool keeps_scale = false;       ///< real coordinates are stored on KnownValues::grid
  bool grid_is_stated = false;    ///< coordinates are rounded to a grid that the user states
  /// The grid chosen for real coordinates has longer steps than their decimals, or than 0.001.
  bool grid_is_coarse = false;
  std::optional<Vec3> fitting_scale;  ///< scales at which 32 bits hold all coordinates; none if the bounds are unknown
  /// Bits of the byte kLasReturnByte that each record gets: a return number and a number of returns of 1, where the
  /// records have no such field.
  std::byte missing_returns{0};
  bool overlap_by_class = false;  ///< records have no overlap flags: points of class 12 (overlap) get the flag

  /// Returns the byte after `count` uncompressed points.
  std::uint64_t points_end(std::uint64_t count) const;
};

/// Lays out the file in one of two ways.
/// 1. The records begin with the records of a LAS input, except that coordinates may be real numbers. All parts of the
/// input are kept, except those named at LasLayout. Made fields become extra bytes, or are stored in the field of the
/// point format that has their name (classification, ...).
/// 2. The records begin otherwise, the user states another point format, a made field exists only in another point
/// format (colours), or the output is COPC and the input has extra bytes of several values. choose_las_point_format()
/// chooses the shortest of the point formats that hold the most fields; formats 0 to 5 are allowed only if an input is
/// LAS or was made from LAS, or if the user states them or a version before 1.4. The VLRs and EVLRs of a LAS input are
/// kept, except those named at LasLayout. A value that does not fit its LAS field is rounded to the nearest value that
/// the field holds; extra bytes hold it exactly.
LasLayout lay_out_las(const OutputPlan& plan, LasPoints points = LasPoints::plain);

/// Returns whether `schema` begins with the records of `input`. The coordinates may have another scale and offset, or
/// be real numbers at the beginning of the record.
bool las_begins_with_records_of(const LasParts& input, const Schema& schema);

/// Returns whether records of `schema` begin with the records of `input` and the user states no other point format.
bool las_keeps_records(const LasParts& input, const Schema& schema, const FileLayout& layout);

/// Returns the point formats to choose from. `from_las`: an input is LAS or was made from LAS.
LasChoice las_choice(const FileLayout& layout, bool from_las);

/// Returns whether signed integers of 32 bits, as LAS stores them, hold all coordinates. If so, the coordinates stay
/// unchanged unless a grid is stated, and no bounds are needed to choose a scale.
bool las_keeps_scale(const PositionFields& p);

/// The VLRs that describe the records of the output.
struct LasDescriptions {
  ExtraBytesVlr extra_bytes;
  bool extended = false;       ///< true if extra_bytes must be written
  bool keeps_records = false;  ///< true if records begin with the records of the input
};

/// Sets the pieces and VLRs of the layout, the header entries about them and about the coordinate reference system, and
/// warnings about contents of the inputs that are lost. `input`: null unless the first input is LAS. The header must
/// have the version, point format and record length of the output.
void place_las_pieces(const OutputPlan& plan, LasPoints points, const LasParts* input,
                      const LasDescriptions& descriptions, LasLayout& layout);

}  // namespace pointsweep
