// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_point_formats.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>
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
  schema.fields.push_back(
      {.name = std::move(name), .type = Type::u8, .offset = byte, .bit_shift = shift, .bit_width = width});
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

/// Point formats from the shortest record to the longest.
constexpr std::array kByLength{0, 2, 1, 6, 3, 7, 8, 4, 9, 5, 10};
/// The point format with the fields of all formats 0 to 5, and the point format with the fields of all formats 6 to 10.
constexpr int kFullestLegacy = 5, kFullestModern = 10;

constexpr std::array<std::string_view, 3> kColors{"red", "green", "blue"};
constexpr std::array<std::string_view, 7> kWaveform{
    "wavepacket_index", "wavepacket_offset", "wavepacket_size", "return_point_wave_location", "x_t", "y_t", "z_t"};

bool is_coordinate(std::string_view name) { return name == "x" || name == "y" || name == "z"; }

bool has_single(const Schema& schema, std::string_view name) {
  const auto at = schema.find(name);
  return at && schema.fields[*at].count == 1;
}

/// Returns false for a colour or a part of a waveform packet if other members of its group are missing.
template <class Group>
bool is_complete(const Schema& schema, std::string_view name, const Group& group) {
  if (std::ranges::find(group, name) == group.end()) return true;
  return std::ranges::all_of(group, [&](std::string_view other) { return has_single(schema, other); });
}

bool only_modern_has(const std::string& name) { return !las_point_schema(kFullestLegacy).find(name).has_value(); }

const Field* target_in(const Schema& format, const std::string& name) {
  const auto at = format.find(name);
  return at ? &format.fields[*at] : nullptr;
}

}  // namespace

int las_minor_of(int point_format) { return point_format >= 6 ? 4 : point_format >= 4 ? 3 : point_format >= 2 ? 2 : 0; }

bool las_has_waveforms(int point_format) { return kParts[point_format].waveform; }

bool las_has_time(int point_format) { return las_point_schema(point_format).find("gps_time").has_value(); }

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

std::vector<std::string> las_names_in(const Schema& schema) {
  std::vector<std::string> names;
  for (const int format : {kFullestModern, kFullestLegacy}) {
    for (const Field& field : las_point_schema(format).fields) {
      if (is_coordinate(field.name) || std::ranges::find(names, field.name) != names.end()) continue;
      if (!has_single(schema, field.name)) continue;
      if (is_complete(schema, field.name, kColors) && is_complete(schema, field.name, kWaveform))
        names.push_back(field.name);
    }
  }
  return names;
}

bool is_las_name(const std::string& name) {
  return !is_coordinate(name) && std::ranges::any_of(std::array{kFullestModern, kFullestLegacy}, [&](int format) {
    return las_point_schema(format).find(name).has_value();
  });
}

bool las_field_holds(const Field& target, const Field& source, const ValueRange& range) {
  if (target.type == source.type && target.is_plain() && source.is_plain()) return true;
  constexpr double kWholeInDouble = 9007199254740992, kWholeInFloat = 16777216;
  if (target.type == Type::f64) {
    return source.type == Type::f32 || source.type == Type::f64 || range.within(-kWholeInDouble, kWholeInDouble);
  }
  if (target.type == Type::f32) return range.whole && range.within(-kWholeInFloat, kWholeInFloat);
  const ValueRange held = range_of_type(target);
  return (range.whole || target.scale != 1) && range.within(held.lo, held.hi);
}

bool LasChoice::has(int point_format) const {
  if (format) return point_format == *format;
  return (legacy || point_format >= kFirstModernLasFormat) && las_minor_of(point_format) <= most_minor;
}

int choose_las_point_format(const Schema& schema, const std::vector<ValueRange>& ranges, const LasChoice& choice) {
  const std::vector<std::string> names = las_names_in(schema);
  int best = kFullestModern;
  std::ptrdiff_t fewest = std::numeric_limits<std::ptrdiff_t>::max();
  for (const int format : kByLength) {
    if (!choice.has(format)) continue;
    const Schema fields = las_point_schema(format);
    const auto left_out = std::ranges::count_if(names, [&](const std::string& name) {
      const Field* target = target_in(fields, name);
      const std::size_t source = *schema.find(name);
      return target == nullptr || !las_field_holds(*target, schema.fields[source], ranges[source]);
    });
    if (left_out >= fewest) continue;
    fewest = left_out;
    best = format;
  }
  return best;
}

std::vector<std::size_t> undecided_las_fields(const Schema& schema, const std::vector<ValueRange>& ranges,
                                              const LasChoice& choice) {
  const std::vector<std::string> names = las_names_in(schema);
  std::vector<int> formats = {kFullestModern};
  if (choice.is_stated())
    formats = {choice.format.value_or(choice.most_minor < 2   ? 1
                                      : choice.most_minor < 3 ? 3
                                      : choice.most_minor < 4 ? kFullestLegacy
                                                              : kFullestModern)};
  else if (choice.legacy && std::ranges::none_of(names, only_modern_has))
    formats.push_back(kFullestLegacy);
  std::vector<std::size_t> undecided;
  for (const std::string& name : names) {
    const std::size_t source = *schema.find(name);
    for (const int format : formats) {
      const Schema fields = las_point_schema(format);
      const Field* target = target_in(fields, name);
      const bool decided =
          target == nullptr ? !choice.is_stated() : las_field_holds(*target, schema.fields[source], ranges[source]);
      if (decided) continue;
      undecided.push_back(source);
      break;
    }
  }
  return undecided;
}

}  // namespace pointsweep
