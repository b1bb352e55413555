// SPDX-License-Identifier: MIT
#include "pointsweep/verify/rows/field_pair.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>

#include "pointsweep/formats/field_names.h"
#include "pointsweep/points/color_depth.h"

namespace pointsweep {

namespace {

constexpr std::size_t kLasNameBytes = 32;
/// The end that a writer adds to the name of an attribute of the input if a made attribute has the same name.
constexpr std::string_view kOfInput = "_input";

Field component_of(Field field, std::uint32_t component) {
  field.offset += component * static_cast<std::uint32_t>(size_of(field.type));
  field.count = 1;
  return field;
}

bool is_plain(const Field& field, Type type) { return field.type == type && field.is_plain(); }

/// Returns a component of the field as one file of the cloud stores it. The file can differ only from a float64 field,
/// the type in which the cloud joins fields that its files store in different ways.
Field field_in_file(const Field& component, std::uint32_t number, const Schema* file) {
  const auto at = file != nullptr ? file->find(component.name) : std::nullopt;
  if (!at || !is_plain(component, Type::f64) || number >= file->fields[*at].count) return component;
  return component_of(file->fields[*at], number);
}

bool stored_alike(const Field& a, const Field& b) {
  return a.type == b.type && a.bit_width == 0 && b.bit_width == 0 && a.scale == b.scale && a.bias == b.bias;
}

std::uint64_t bits_at(const Field& field, const std::byte* record) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, record + field.offset, size_of(field.type));
  return bits;
}

/// Returns the value that a reader gets after `value` was stored in `field`; returns `value` itself if the field cannot
/// hold it.
double stored_and_read(Field field, double value) {
  if (!holds(field, value)) return value;
  std::byte bytes[sizeof(double)]{};
  field.offset = 0;
  set_value(field, bytes, value);
  return value_of(field, bytes);
}

bool is_axis_name(const std::string& name) {
  const std::string known = library_name_of(name);
  return known == "x" || known == "y" || known == "z";
}

struct Place {
  std::size_t field;
  std::uint32_t component;
};

std::optional<Place> exactly(const Schema& schema, const std::string& name, std::uint32_t component) {
  for (std::size_t f = 0; f < schema.fields.size(); ++f)
    if (schema.fields[f].name == name && component < schema.fields[f].count) return Place{f, component};
  return std::nullopt;
}

/// Returns the names that a column may have in a format with names of its own, the likeliest first. If the format
/// gives several columns one name, PCD and E57 add a number to the later columns, and LAS renames the earlier columns.
std::vector<std::string> names_in_format(const std::vector<std::string>& columns, std::size_t column,
                                         StoredName stored_name) {
  const std::string own = stored_name(columns[column]);
  std::size_t before = 0;
  bool is_last = true;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (c == column || stored_name(columns[c]) != own) continue;
    c < column ? void(++before) : void(is_last = false);
  }
  const std::string number = before == 0 ? "" : fmt::format("_{}", before + 1);
  std::vector<std::string> names;
  if (!is_last) {
    const std::string input = own.substr(0, kLasNameBytes - kOfInput.size()) + std::string(kOfInput);
    names.push_back(input.substr(0, kLasNameBytes - number.size()) + number);
  }
  if (before > 0) names.push_back(own + number);
  names.push_back(own);
  return names;
}

/// Finds a component of an attribute under each name that a writer may have given it.
class PlaceFinder {
 public:
  PlaceFinder(const Schema& from, std::size_t index, const Schema& to, StoredName stored_name)
      : from_(from), field_(from.fields[index]), to_(to) {
    std::size_t column = 0;
    for (std::size_t f = 0; f < index; ++f) column += from.fields[f].count;
    const std::vector<std::string> columns = column_names(from);
    for (std::uint32_t c = 0; c < field_.count; ++c, ++column) {
      columns_.push_back(columns[column]);
      in_format_.push_back(stored_name == nullptr ? std::vector{columns[column]}
                                                  : names_in_format(columns, column, stored_name));
    }
  }

  std::optional<Place> find(std::uint32_t component) const {
    const std::string& name = field_.name;
    const bool is_alone = in_format_[component].size() == 1;  // no other column has this name in the format
    for (const std::string& added : {fmt::format("{}_{}", name, name_of(field_.type)), name + std::string(kOfInput)})
      if (!exactly(from_, added, 0) && (is_alone || !added.ends_with(kOfInput)))
        if (const auto place = cut(added) == cut(name) ? exactly(to_, added, component) : numbered(added, component))
          return place;
    if (field_.count == 1)
      if (const auto place = named_by_format(component)) return place;
    if (const auto place = exactly(to_, columns_[component], 0)) return place;
    if (const auto place = numbered(name, component)) return place;
    const auto spelled = to_.find(library_name_of(name));
    if (spelled && component < to_.fields[*spelled].count) return Place{*spelled, component};
    return named_by_format(component);
  }

 private:
  /// Returns the name, cut to the 32 bytes that LAS allows.
  static std::string cut(const std::string& name) { return name.substr(0, kLasNameBytes); }

  std::optional<Place> named_by_format(std::uint32_t component) const {
    for (const std::string& name : in_format_[component])
      if (const auto place = exactly(to_, name, 0)) return place;
    return std::nullopt;
  }

  /// Finds the component as NAME, NAME_0 or NAME[0], with NAME also cut to the 32 bytes that LAS allows.
  std::optional<Place> numbered(const std::string& name, std::uint32_t component) const {
    if (const auto place = exactly(to_, name, component)) return place;
    if (field_.count == 1) return exactly(to_, cut(name), component);
    const std::string index = fmt::format("[{}]", component);
    if (const auto place = exactly(to_, name.substr(0, kLasNameBytes - index.size()) + index, 0)) return place;
    return exactly(to_, fmt::format("{}_{}", name, component), 0);
  }

  const Schema& from_;
  const Field& field_;
  const Schema& to_;
  std::vector<std::string> columns_;                 ///< names of the components in text
  std::vector<std::vector<std::string>> in_format_;  ///< names of the components in the format of the output
};

}  // namespace

FieldPair::FieldPair(std::string name, const Field& from, std::uint32_t from_component, const Field& to,
                     std::uint32_t to_component, StoredPlaces places)
    : name_(std::move(name)),
      from_component_(from_component),
      to_component_(to_component),
      from_(component_of(from, from_component)),
      to_(component_of(to, to_component)),
      places_(places),
      is_coordinate_(is_axis_name(name_)),
      decimals_(Field{}) {
  compare_as(from_, to_);
}

void FieldPair::compare_as(const Field& from_file, const Field& to_file) {
  from_file_ = from_file, to_file_ = to_file;
  const bool is_double = is_plain(to_file, Type::f64);
  bitwise_ = stored_alike(from_, to_) && stored_alike(from_file, to_file) && !places_.decimals && !places_.single;
  decimals_ = GridDecimals(is_double ? from_file : Field{});
  single_ = is_double && (places_.single || is_plain(from_file, Type::f32));
}

FieldPair FieldPair::in_files(const Schema* from, const Schema* to) const {
  FieldPair pair = *this;
  pair.compare_as(field_in_file(from_, from_component_, from), field_in_file(to_, to_component_, to));
  return pair;
}

std::uint64_t FieldPair::word_of(double value) const {
  if (single_) value = static_cast<double>(static_cast<float>(value));
  value = decimals_.of(value);
  return std::bit_cast<std::uint64_t>(std::isnan(value) ? std::numeric_limits<double>::quiet_NaN() : value);
}

double FieldPair::stored(double value) const {
  if (single_) value = static_cast<double>(static_cast<float>(value));
  value = stored_and_read(to_file_, value);
  return places_.decimals ? std::stod(fmt::format("{:.{}f}", value, *places_.decimals)) : value;
}

std::uint64_t FieldPair::expected(const std::byte* from_record) const {
  return bitwise_ ? bits_at(from_, from_record) : word_of(stored(value_of(from_, from_record)));
}

double FieldPair::rounding(const std::byte* from_record) const {
  if (bitwise_) return 0;
  const double value = value_of(from_, from_record), change = std::abs(stored(value) - value);
  return change > std::ldexp(std::abs(value) + std::abs(to_file_.bias), -50) ? change : 0;
}

std::uint64_t FieldPair::found(const std::byte* to_record) const {
  return bitwise_ ? bits_at(to_, to_record) : word_of(value_of(to_, to_record));
}

double FieldPair::found_number(const std::byte* to_record) const {
  const double value = found_value(to_record);
  return single_ && !places_.decimals ? static_cast<double>(static_cast<float>(value)) : value;
}

double FieldPair::resolution(double value) const {
  // Both the value and the number that a reader computes from the stored integer are rounded a few times in double
  // precision.
  const double of_double = std::ldexp(std::abs(value), -50);
  const double of_single = single_ ? std::ldexp(std::abs(value), -24) : 0;
  if (places_.decimals) return 0.5 * std::pow(10, -*places_.decimals) + of_double + of_single;
  if (is_plain(to_file_, Type::f64)) return of_single;
  if (is_plain(to_file_, Type::f32)) return bitwise_ ? 0 : std::ldexp(std::abs(value), -24) + 0x1p-150;
  return std::abs(to_file_.scale) / 2 + of_double;
}

std::optional<std::vector<FieldPair>> pairs_of_field(const Schema& from, std::size_t index, const Schema& to,
                                                     StoredPlaces places, StoredName stored_name) {
  const std::optional<Schema> scaled = has_wide_colors(to) ? with_wide_colors(from) : std::nullopt;
  const Field& field = (scaled ? *scaled : from).fields[index];
  const PlaceFinder finder(from, index, to, stored_name);
  const bool is_coordinate = is_axis_name(field.name);
  std::vector<FieldPair> pairs;
  for (std::uint32_t c = 0; c < field.count; ++c) {
    const auto place = finder.find(c);
    if (!place) return std::nullopt;
    const std::string name = field.count == 1 ? field.name : fmt::format("{}[{}]", field.name, c);
    pairs.emplace_back(name, field, c, to.fields[place->field], place->component,
                       is_coordinate ? places : StoredPlaces{});
  }
  return pairs;
}

std::size_t file_of_row(std::span<const FileOfRows> files, std::uint64_t row) {
  return static_cast<std::size_t>(std::ranges::upper_bound(files, row, {}, &FileOfRows::first) - files.begin()) - 1;
}

FilePairs::FilePairs(const RowSource& in, const RowSource& out, bool in_any_order, std::vector<FieldPair> pairs)
    : pairs_(std::move(pairs)),
      in_{in.files(), in.count()},
      out_{out.files(), out.count()},
      by_file_(!in_any_order && in.files().size() == out.files().size() && in.files().size() > 1) {}

std::span<const FieldPair> FilePairs::of(Side& side, std::uint64_t row) {
  if (!by_file_) return pairs_;
  if (row >= side.first && row < side.end) return side.pairs;
  const std::size_t file = file_of_row(side.files, row);
  side.first = side.files[file].first;
  side.end = file + 1 < side.files.size() ? side.files[file + 1].first : side.count;
  side.pairs.clear();
  for (const FieldPair& pair : pairs_)
    side.pairs.push_back(pair.in_files(in_.files[file].schema, out_.files[file].schema));
  return side.pairs;
}

}  // namespace pointsweep
