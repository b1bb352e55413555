// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_format.h"

#include "pointsweep/formats/format.h"
#include "pointsweep/formats/las/las_extra_bytes.h"
#include "pointsweep/formats/las/las_layout.h"
#include "pointsweep/formats/las/las_point_formats.h"
#include "pointsweep/formats/las/las_reader.h"
#include "pointsweep/formats/las/laz_layout.h"

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

/// Returns the value of an attribute of LAS in files without it: 1 for return numbers, else 0. Nothing for other names.
std::optional<double> own_field(std::string_view name) {
  if (name == "return_number" || name == "number_of_returns") return 1;
  for (int format = 0; las_record_length(format); ++format)
    for (const Field& field : las_point_schema(format, {1, 1, 1}, {}).fields)
      if (field.name == name) return 0;
  return std::nullopt;
}

bool needs_bounds(const Schema& schema, const FileLayout& layout) {
  return layout.scale || layout.offset || !las_keeps_scale(position_fields(schema, "the input"));
}

}  // namespace

const Format kLasFormat = {.name = "LAS",
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

const Format kLazFormat = {.name = "LAZ",
                           .title = "LAZ 1.0 to 1.4",
                           .details = "las.md",
                           .reads = "the same, compressed",
                           .writes = "LAZ with 50,000 points a chunk",
                           .extensions = kLazExtensions,
                           .codec = "LASzip",
                           .has_codec = has_laz,
                           .is = is_plain_laz,
                           .open = open_las,
                           .create = create_laz_writer,
                           .holds_crs = true,
                           .holds_provenance = true,
                           .real_coordinates = false,
                           .states_bounds = true,
                           .encoder_bytes = laz_encoder_bytes,
                           .name_bytes = kLasNameBytes,
                           .stored_name = las_dimension_name,
                           .own_field = own_field,
                           .layout = kLayout,
                           .needs_bounds = needs_bounds,
                           .values = las_values,
                           .values_need_points = las_values_need_points,
                           .stored_coordinate = las_stored_coordinate};

const Format kCopcFormat = {.name = "COPC",
                            .title = "COPC 1.0",
                            .details = "las.md#copc",
                            .reads = "as LAZ",
                            .writes = "levels of detail",
                            .extensions = kCopcExtensions,
                            .codec = "LASzip",
                            .has_codec = has_laz,
                            .is = is_copc,
                            .open = open_las,
                            .create = create_copc_writer,
                            .holds_crs = true,
                            .holds_provenance = true,
                            .reorders = true,
                            .real_coordinates = false,
                            .states_bounds = true,
                            .encoder_bytes = copc_encoder_bytes,
                            .aside_bytes = copc_aside_bytes,
                            .name_bytes = kLasNameBytes,
                            .stored_name = las_dimension_name,
                            .own_field = own_field,
                            .layout = kLayout,
                            .needs_bounds = needs_bounds,
                            .values = copc_values,
                            .values_need_points = copc_values_need_points,
                            .stored_coordinate = copc_stored_coordinate};

}  // namespace pointsweep
