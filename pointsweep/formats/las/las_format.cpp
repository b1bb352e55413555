// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_format.h"

#include "pointsweep/formats/format.h"
#include "pointsweep/formats/las/las_extra_bytes.h"
#include "pointsweep/formats/las/las_layout.h"
#include "pointsweep/formats/las/las_point_formats.h"
#include "pointsweep/formats/las/las_reader.h"

namespace pointsweep {
namespace {

constexpr std::string_view kLasExtensions[] = {".las"}, kLazExtensions[] = {".laz"}, kCopcExtensions[] = {".copc.laz"};
constexpr std::string_view kLayout[] = {"scale", "offset", "point_format", "las_version"};

/// Returns whether the top bit of the point format (byte 104) marks the file as compressed.
bool is_compressed(std::string_view head) {
  return head.starts_with("LASF") && head.size() > 104 && (static_cast<unsigned char>(head[104]) & 0x80) != 0;
}
bool is_uncompressed(std::string_view head) { return head.starts_with("LASF") && !is_compressed(head); }

/// Returns whether the file is compressed and its first VLR is the info VLR of COPC.
bool is_copc(std::string_view head) {
  constexpr std::size_t kUserAt = 375 + 2;
  return is_compressed(head) && head.size() > kUserAt + 5 && head.substr(kUserAt, 5) == std::string_view("copc", 5);
}

bool is_plain_laz(std::string_view head) { return is_compressed(head) && !is_copc(head); }

/// Returns the value of a LAS attribute for points that lack the attribute: 1 for return numbers, else 0. Nothing for
/// other names.
std::optional<double> own_field(std::string_view name) {
  if (name == "return_number" || name == "number_of_returns") return 1;
  for (int format = 0; las_record_length(format); ++format)
    for (const Field& field : las_point_schema(format).fields)
      if (field.name == name) return 0;
  return std::nullopt;
}

bool needs_bounds(const Schema& schema, const FileLayout& layout) {
  return layout.scale || layout.offset || !las_keeps_scale(position_fields(schema, "the input"));
}

constexpr Format kLas = {.name = "LAS",
                         .title = "LAS 1.0 to 1.4",
                         .details = "las.md",
                         .reads = "point formats 0 to 10",
                         .writes = "same",
                         .extensions = kLasExtensions,
                         .is = is_uncompressed,
                         .open = open_las,
                         .create = create_las_writer,
                         .holds_crs = true,
                         .holds_provenance = true,
                         .real_coordinates = false,
                         .states_bounds = true,
                         .name_bytes = kLasNameBytes,
                         .stored_name = las_dimension_name,
                         .own_field = own_field,
                         .layout = kLayout,
                         .needs_bounds = needs_bounds,
                         .values = las_values,
                         .values_need_points = las_values_need_points,
                         .stored_coordinate = las_stored_coordinate};

/// Returns the description of LAZ, which differs from that of LAS in these members.
constexpr Format laz_format() {
  Format laz = kLas;
  laz.name = "LAZ";
  laz.title = "LAZ 1.0 to 1.4";
  laz.reads = "the same, compressed";
  laz.writes = "LAZ with 50,000 points a chunk";
  laz.extensions = kLazExtensions;
  laz.codec = "LASzip";
  laz.is = is_plain_laz;
  laz.create = create_laz_writer;
  laz.encoder_bytes = laz_encoder_bytes;
  return laz;
}

/// Returns the description of COPC, which differs from that of LAZ in these members.
constexpr Format copc_format() {
  Format copc = laz_format();
  copc.name = "COPC";
  copc.title = "COPC 1.0";
  copc.details = "las.md#copc";
  copc.reads = "as LAZ";
  copc.writes = "levels of detail";
  copc.extensions = kCopcExtensions;
  copc.is = is_copc;
  copc.create = create_copc_writer;
  copc.reorders = true;
  copc.encoder_bytes = copc_encoder_bytes;
  copc.aside_bytes = copc_aside_bytes;
  copc.values = copc_values;
  copc.values_need_points = copc_values_need_points;
  copc.stored_coordinate = copc_stored_coordinate;
  return copc;
}

}  // namespace

constexpr Format kLasFormat = kLas, kLazFormat = laz_format(), kCopcFormat = copc_format();

}  // namespace pointsweep
