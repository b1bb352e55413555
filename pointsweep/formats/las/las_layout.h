// SPDX-License-Identifier: MIT
/// The layout of a LAS output, decided before the first record: header, VLRs, the place of each value, and the
/// parts around the points.
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
#include "pointsweep/formats/las/laz_layout.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Bytes [begin, end) of the input, copied unchanged.
struct LasPiece {
  std::uint64_t begin = 0, end = 0;
  std::uint64_t size() const { return end - begin; }
};

/// The way in which a file holds its points; `nodes`: compressed, node by node of an octree (COPC).
enum class LasPoints { plain, compressed, nodes };

/// The file is: header, `first_vlrs`, `before` of the input, `added_vlrs`, `between` of the input, `provenance_vlrs`,
/// `after` of the input, points, `tail` of the input. VLRs about the compression of the input and its nodes are left
/// out.
struct LasLayout {
  LasHeader header;                        ///< all but counts and bounds
  std::shared_ptr<const InputFile> input;  ///< null if the input is not LAS
  std::vector<LasPiece> before, between;
  LasPiece after;
  std::vector<LasPiece> tail;
  std::vector<std::byte> first_vlrs;       ///< with its header, the COPC VLR, which is to be filled in
  std::vector<std::byte> added_vlrs;       ///< with their headers; empty if the pieces of the input have all
  std::vector<std::byte> provenance_vlrs;  ///< likewise; those of the input are in its pieces
  std::vector<std::string> warnings;       ///< what the file cannot hold
  std::optional<LazLayout> laz;            ///< if points are to be compressed

  /// Two schemas with fields paired by name: what comes, and the records of the file.
  Schema from, to;
  Field x, y, z;                      ///< of `from`
  bool positions_change = false;      ///< coordinates have to be quantised, which may fail
  bool points_moved = false;          ///< those are of points that stages have moved
  bool keeps_scale = false;           ///< those are rounded to steps of the input
  bool grid_is_stated = false;        ///< all are rounded to steps that the user states
  std::optional<Vec3> fitting_scale;  ///< scales that hold all coordinates, where the bounds are known
  bool returns_missing = false;       ///< no return numbers come: every point is return 1 of 1
  bool overlap_by_class = false;      ///< no overlap flags come: points of class 12 (overlap) get them

  /// If they are not compressed.
  std::uint64_t points_end(std::uint64_t count) const;
};

/// Input LAS and records that begin with its records, whose coordinates may be real numbers instead: everything of it
/// is kept, made fields are appended as extra bytes; a made field that bears the name of one of the point format's
/// (classification, ...) is stored there.
/// Otherwise, and where a made field is one of another point format (colours): the shortest point format that holds the
/// fields (choose_las_point_format(); 6 to 10 only, unless an input is LAS or was); header, VLRs and EVLRs of a LAS
/// input are kept, values that do not fit the LAS field are stored there rounded and as extra bytes exactly.
LasLayout lay_out_las(const OutputPlan& plan, LasPoints points = LasPoints::plain);

/// True if `schema` begins with the records of `input`, whose coordinates may have another scale and offset or be real
/// numbers that stand first in the record.
bool las_begins_with_records_of(const LasParts& input, const Schema& schema);

/// True if records of `schema` are written as those of `input`, since the user asks for no other point format.
bool las_keeps_records(const LasParts& input, const Schema& schema, const FileLayout& layout);

/// Returns the point formats to choose from. `from_las`: an input is or was LAS.
LasChoice las_choice(const FileLayout& layout, bool from_las);

/// True for coordinates that are LAS's own integers: they stay unchanged, and no bounds are needed to choose a scale.
bool las_keeps_scale(const PositionFields& p);

/// The descriptions of the records that VLRs hold.
struct LasDescriptions {
  ExtraBytesVlr extra_bytes;
  bool extended = false;       ///< extra_bytes has to be written
  bool keeps_records = false;  ///< records begin with those of the input
  Crs added_crs;               ///< to be stated beside what the VLRs of the input state
};

/// Sets pieces and VLRs of the layout, and what the header says of them. `input`: null unless the input is LAS. The
/// record length of the header is that of the output.
void place_las_pieces(const OutputPlan& plan, LasPoints points, const LasParts* input,
                      const LasDescriptions& descriptions, LasLayout& layout);

}  // namespace pointsweep
