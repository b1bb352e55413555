// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstring>
#include <iterator>
#include <limits>
#include <set>
#include <utility>

#include "pointsweep/formats/e57/e57_format.h"
#include "pointsweep/formats/field_names.h"
#include "pointsweep/points/with_type.h"

namespace pointsweep {
namespace {

/// Groups of attributes, by the library's names, for which E57 or its extension has names. A group gets the names of
/// E57 only as a whole.
constexpr std::array<std::string_view, 3> kPosition{"x", "y", "z"}, kColors{"red", "green", "blue"},
    kNormal{"nx", "ny", "nz"};
constexpr std::array<std::string_view, 2> kReturns{"return_index", "return_count"};
constexpr std::array<std::string_view, 1> kRow{"row"}, kColumn{"column"}, kIntensity{"intensity"}, kTime{"time_stamp"};

std::string stored_name_of(std::string_view ours) {
  const E57Name& name = *std::ranges::find(kE57Names, ours, &E57Name::ours);
  return name.extension.empty() ? std::string(name.theirs) : fmt::format("{}:{}", name.extension, name.theirs);
}

/// Returns the range of the integers of a field; for unsigned 64-bit fields, the lower half of the range.
std::pair<std::int64_t, std::int64_t> range_of(const Field& field) {
  if (field.bit_width > 0 && field.bit_width < 63) return {0, (std::int64_t{1} << field.bit_width) - 1};
  return with_type(field.type, []<class T>() -> std::pair<std::int64_t, std::int64_t> {
    using Limits = std::numeric_limits<T>;
    if constexpr (!Limits::is_integer)
      return {0, 0};
    else
      return {static_cast<std::int64_t>(Limits::min()),
              static_cast<std::int64_t>(std::min<std::uint64_t>(static_cast<std::uint64_t>(Limits::max()),
                                                                std::numeric_limits<std::int64_t>::max()))};
  });
}

E57Attribute attribute_for(const Field& field, std::string name) {
  using Kind = E57Attribute::Kind;
  E57Attribute a{.name = std::move(name)};
  if (field.type == Type::f32 && field.is_plain()) a.kind = Kind::single;
  if (field.type == Type::f32 || field.type == Type::f64) return a;
  a.kind = has_whole_numbers(field) ? Kind::integer : Kind::scaled_integer;
  std::tie(a.least, a.most) = range_of(field);
  a.scale = field.scale;
  a.offset = field.bias;
  return a;
}

Field component_of(const Field& field, std::uint32_t component) {
  Field one = field;
  one.offset += component * static_cast<std::uint32_t>(size_of(field.type));
  one.count = 1;
  return one;
}

/// Sets the names in E57 of the fields of a group if the schema has all of them, each with one component, and `may_be`
/// is true for each; else changes nothing.
template <std::size_t N, class MayBe>
void name_group(const Schema& schema, const std::array<std::string_view, N>& group, MayBe may_be,
                std::vector<std::string>& names) {
  std::array<std::size_t, N> found{};
  for (std::size_t i = 0; i < N; ++i) {
    const auto field = schema.find(group[i]);
    if (!field || schema.fields[*field].count != 1 || !may_be(schema.fields[*field])) return;
    found[i] = *field;
  }
  for (std::size_t i = 0; i < N; ++i) names[found[i]] = stored_name_of(group[i]);
}

/// Returns the name of each field in the standard or its extension; empty for a field without such a name.
std::vector<std::string> standard_names(const Schema& schema) {
  std::vector<std::string> names(schema.fields.size());
  const auto any = [](const Field&) { return true; };
  name_group(schema, kPosition, any, names);
  name_group(schema, kColors, any, names);
  name_group(schema, kNormal, any, names);
  name_group(schema, kReturns, has_whole_numbers, names);
  name_group(schema, kRow, has_whole_numbers, names);
  name_group(schema, kColumn, has_whole_numbers, names);
  name_group(schema, kIntensity, any, names);
  name_group(schema, kTime, any, names);
  return names;
}

bool is_known_to_e57(std::string_view name) {
  return std::ranges::find(kE57Names, name, &E57Name::theirs) != std::end(kE57Names);
}

}  // namespace

std::uint64_t E57Column::stored(const std::byte* record) const {
  if (!attribute.is_stored_as_integer()) return std::bit_cast<std::uint64_t>(value_of(field, record));
  return with_type(field.type, [&]<class T>() -> std::uint64_t {
    T value;
    std::memcpy(&value, record + field.offset, sizeof value);
    const auto whole = static_cast<std::uint64_t>(static_cast<std::int64_t>(value));
    if (field.bit_width == 0) return whole;
    return whole >> field.bit_shift & ((std::uint64_t{1} << field.bit_width) - 1);
  });
}

std::string e57_name(const std::string& name) {
  std::string stored = name;
  for (char& c : stored)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') c = '_';
  const bool begins_as_xml = stored.size() >= 3 && std::tolower(stored[0]) == 'x' && std::tolower(stored[1]) == 'm' &&
                             std::tolower(stored[2]) == 'l';
  const bool begins_wrong = stored.empty() || std::isdigit(static_cast<unsigned char>(stored[0])) || stored[0] == '-';
  return begins_as_xml || begins_wrong || is_known_to_e57(stored) ? "_" + stored : stored;
}

std::vector<E57Column> e57_columns(const Schema& schema) {
  const std::vector<std::string> standard = standard_names(schema);
  const std::vector<std::string> plain = column_names(schema);
  std::vector<E57Column> columns;
  std::set<std::string> taken;
  std::size_t column = 0;
  for (std::size_t f = 0; f < schema.fields.size(); ++f) {
    const Field& field = schema.fields[f];
    for (std::uint32_t c = 0; c < field.count; ++c, ++column) {
      std::string name = standard[f];
      if (name.empty() && field.name == "invalid_state") continue;
      if (name.empty()) {
        const std::string own = "ps:" + e57_name(plain[column]);
        name = own;
        for (int again = 2; !taken.insert(name).second; ++again) name = fmt::format("{}_{}", own, again);
      }
      columns.push_back({attribute_for(field, std::move(name)), component_of(field, c)});
    }
  }
  const auto is_position = [](const E57Column& c) { return c.attribute.name.starts_with("cartesian"); };
  std::stable_partition(columns.begin(), columns.end(), is_position);
  return columns;
}

std::string changed_e57_names(const std::filesystem::path& path, const Schema& schema) {
  const std::vector<std::string> standard = standard_names(schema), plain = column_names(schema);
  std::vector<std::string> stored;
  for (std::size_t f = 0; f < schema.fields.size(); ++f)
    for (std::uint32_t c = 0; c < schema.fields[f].count; ++c)
      stored.push_back(standard[f].empty() ? e57_name(plain[stored.size()]) : schema.fields[f].name);
  return changed_names(path, "E57", schema, stored);
}

}  // namespace pointsweep
