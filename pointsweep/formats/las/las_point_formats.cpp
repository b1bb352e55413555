// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_point_formats.h"

#include <string>
#include <utility>

namespace pointsweep {
namespace {

/// Degrees per unit of the scan angle of formats 6 to 10.
constexpr double kScanAngleScale = 0.006;

/// The parts of a point format after its core of 20 bytes (formats 0 to 5) or 30 bytes (6 to 10), in this order.
struct Parts {
  bool gps_time, color, nir, waveform;
};

constexpr Parts kParts[kLasPointFormats] = {
    {false, false, false, false}, {true, false, false, false}, {false, true, false, false},
    {true, true, false, false},   {true, false, false, true},  {true, true, false, true},
    {false, false, false, false}, {false, true, false, false}, {false, true, true, false},
    {false, false, false, true},  {false, true, true, true},
};

void append_bits(Schema& schema, std::string name, std::uint32_t byte, std::uint8_t shift, std::uint8_t width) {
  Field field;
  field.name = std::move(name);
  field.type = Type::u8;
  field.offset = byte;
  field.bit_shift = shift;
  field.bit_width = width;
  schema.fields.push_back(std::move(field));
}

void append_position(Schema& schema, Vec3 scale, Vec3 offset) {
  for (int axis = 0; axis < 3; ++axis) {
    Field& field = schema.fields[schema.append(std::string(1, "xyz"[axis]), Type::i32)];
    field.scale = scale[axis];
    field.bias = offset[axis];
  }
}

void append_legacy_core(Schema& schema) {
  append_bits(schema, "return_number", 14, 0, 3);
  append_bits(schema, "number_of_returns", 14, 3, 3);
  append_bits(schema, "scan_direction_flag", 14, 6, 1);
  append_bits(schema, "edge_of_flight_line", 14, 7, 1);
  append_bits(schema, "classification", 15, 0, 5);
  append_bits(schema, "synthetic", 15, 5, 1);
  append_bits(schema, "key_point", 15, 6, 1);
  append_bits(schema, "withheld", 15, 7, 1);
  schema.stride = 16;
  schema.append("scan_angle", Type::i8);
  schema.append("user_data", Type::u8);
  schema.append("point_source_id", Type::u16);
}

void append_core(Schema& schema) {
  append_bits(schema, "return_number", 14, 0, 4);
  append_bits(schema, "number_of_returns", 14, 4, 4);
  append_bits(schema, "synthetic", 15, 0, 1);
  append_bits(schema, "key_point", 15, 1, 1);
  append_bits(schema, "withheld", 15, 2, 1);
  append_bits(schema, "overlap", 15, 3, 1);
  append_bits(schema, "scanner_channel", 15, 4, 2);
  append_bits(schema, "scan_direction_flag", 15, 6, 1);
  append_bits(schema, "edge_of_flight_line", 15, 7, 1);
  schema.stride = 16;
  schema.append("classification", Type::u8);
  schema.append("user_data", Type::u8);
  schema.fields[schema.append("scan_angle", Type::i16)].scale = kScanAngleScale;
  schema.append("point_source_id", Type::u16);
  schema.append("gps_time", Type::f64);
}

void append_waveform(Schema& schema) {
  schema.append("wavepacket_index", Type::u8);
  schema.append("wavepacket_offset", Type::u64);
  schema.append("wavepacket_size", Type::u32);
  schema.append("return_point_wave_location", Type::f32);
  schema.append("x_t", Type::f32);
  schema.append("y_t", Type::f32);
  schema.append("z_t", Type::f32);
}

}  // namespace

int las_minor_of(int point_format) { return point_format >= 6 ? 4 : point_format >= 4 ? 3 : point_format >= 2 ? 2 : 0; }

bool las_has_waveforms(int point_format) { return kParts[point_format].waveform; }

std::optional<std::uint16_t> las_record_length(int point_format) {
  if (point_format < 0 || point_format >= kLasPointFormats) return std::nullopt;
  const Parts& parts = kParts[point_format];
  return static_cast<std::uint16_t>((point_format >= 6 ? 30 : 20) + (parts.gps_time ? 8 : 0) + (parts.color ? 6 : 0) +
                                    (parts.nir ? 2 : 0) + (parts.waveform ? 29 : 0));
}

Schema las_point_schema(int point_format, Vec3 scale, Vec3 offset) {
  const Parts& parts = kParts[point_format];
  Schema schema;
  append_position(schema, scale, offset);
  schema.append("intensity", Type::u16);
  point_format >= 6 ? append_core(schema) : append_legacy_core(schema);
  if (parts.gps_time) schema.append("gps_time", Type::f64);
  if (parts.color) {
    for (const char* name : {"red", "green", "blue"}) schema.append(name, Type::u16);
  }
  if (parts.nir) schema.append("nir", Type::u16);
  if (parts.waveform) append_waveform(schema);
  return schema;
}

}  // namespace pointsweep
