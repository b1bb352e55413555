// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_fields.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>

#include "pointsweep/formats/las/las_point_formats.h"

namespace pointsweep {
namespace {

/// Point formats from the shortest record to the longest.
constexpr std::array kByLength{0, 2, 1, 6, 3, 7, 8, 4, 9, 5, 10};
/// The formats of each family that have all of its fields.
constexpr int kFullestLegacy = 5, kFullestModern = 10;

constexpr std::array<std::string_view, 3> kColors{"red", "green", "blue"};
constexpr std::array<std::string_view, 7> kWaveform{
    "wavepacket_index", "wavepacket_offset", "wavepacket_size", "return_point_wave_location", "x_t", "y_t", "z_t"};

bool is_coordinate(std::string_view name) { return name == "x" || name == "y" || name == "z"; }

bool has_single(const Schema& schema, std::string_view name) {
  const auto at = schema.find(name);
  return at && schema.fields[*at].count == 1;
}

/// False for a colour or a part of a waveform packet whose companions are missing.
template <class Group>
bool is_complete(const Schema& schema, std::string_view name, const Group& group) {
  if (std::find(group.begin(), group.end(), name) == group.end()) return true;
  return std::all_of(group.begin(), group.end(), [&](std::string_view other) { return has_single(schema, other); });
}

bool only_modern_has(const std::string& name) {
  return !las_point_schema(kFullestLegacy, {1, 1, 1}, {}).find(name).has_value();
}

const Field* target_in(const Schema& format, const std::string& name) {
  const auto at = format.find(name);
  return at ? &format.fields[*at] : nullptr;
}

}  // namespace

std::vector<std::string> las_names_in(const Schema& schema) {
  std::vector<std::string> names;
  for (const int format : {kFullestModern, kFullestLegacy}) {
    for (const Field& field : las_point_schema(format, {1, 1, 1}, {}).fields) {
      if (is_coordinate(field.name) || std::find(names.begin(), names.end(), field.name) != names.end()) continue;
      if (!has_single(schema, field.name)) continue;
      if (is_complete(schema, field.name, kColors) && is_complete(schema, field.name, kWaveform))
        names.push_back(field.name);
    }
  }
  return names;
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

int choose_las_point_format(const Schema& schema, const std::vector<ValueRange>& ranges, bool legacy) {
  const std::vector<std::string> names = las_names_in(schema);
  int best = kFullestModern;
  std::ptrdiff_t fewest = std::numeric_limits<std::ptrdiff_t>::max();
  for (const int format : kByLength) {
    if (format < 6 && !legacy) continue;
    const Schema fields = las_point_schema(format, {1, 1, 1}, {});
    const auto left_out = std::count_if(names.begin(), names.end(), [&](const std::string& name) {
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
                                              bool legacy) {
  const std::vector<std::string> names = las_names_in(schema);
  legacy = legacy && std::none_of(names.begin(), names.end(), only_modern_has);
  std::vector<std::size_t> undecided;
  for (const std::string& name : names) {
    const std::size_t source = *schema.find(name);
    for (const int format : {kFullestModern, kFullestLegacy}) {
      if (format == kFullestLegacy && !legacy) continue;
      const Schema fields = las_point_schema(format, {1, 1, 1}, {});
      const Field* target = target_in(fields, name);
      if (target == nullptr || las_field_holds(*target, schema.fields[source], ranges[source])) continue;
      undecided.push_back(source);
      break;
    }
  }
  return undecided;
}

}  // namespace pointsweep
