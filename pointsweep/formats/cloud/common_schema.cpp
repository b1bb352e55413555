// SPDX-License-Identifier: MIT
#include "pointsweep/formats/cloud/common_schema.h"

#include <algorithm>
#include <iterator>
#include <limits>

#include "pointsweep/fail.h"
#include "pointsweep/points/color_depth.h"
#include "pointsweep/points/input_row.h"

namespace pointsweep {
namespace {

constexpr int kOverlapClass = 12;  ///< overlap of flight lines in point formats 0 to 5 (LAS 1.4 R15, Table 9)

using Readers = std::vector<std::shared_ptr<Reader>>;

/// Returns the schema after its coordinates are converted to `grid`.
Schema on_grid(Schema schema, const LasQuantization& grid) {
  for (int axis = 0; axis < 3; ++axis) {
    Field& field = schema.fields[*schema.find(kAxisNames[static_cast<std::size_t>(axis)])];
    field.scale = grid.scale[axis];
    field.bias = grid.offset[axis];
  }
  return schema;
}

bool is_plain_float(const Field& field) { return field.type == Type::f32 && field.is_plain(); }

/// Returns whether a float holds every value of the field.
bool fits_float(const Field& field) {
  return is_plain_float(field) || (has_whole_numbers(field) && range_of_type(field).within(-16777216, 16777216));
}

/// Returns the smallest type that holds every value of both fields. If there is none, returns int64 for integers and
/// float64 for other values; class WideIntegers finds the values that this type does not hold.
Type common_type(const Field& a, const Field& b) {
  if (!has_whole_numbers(a) || !has_whole_numbers(b)) return fits_float(a) && fits_float(b) ? Type::f32 : Type::f64;
  ValueRange both = range_of_type(a);
  both.include(range_of_type(b));
  for (const Type type : {Type::u8, Type::i8, Type::u16, Type::i16, Type::u32, Type::i32, Type::u64, Type::i64}) {
    Field whole;
    whole.type = type;
    const ValueRange range = range_of_type(whole);
    if (both.within(range.lo, range.hi)) return type;
  }
  return Type::i64;
}

bool same_storage(const Field& a, const Field& b) {
  return a.type == b.type && a.bit_width == b.bit_width && a.scale == b.scale && a.bias == b.bias;
}

/// Returns `field` at offset 0. A bit field becomes a field of whole bytes.
Field unpacked(const Field& field) {
  Field out = field;
  out.offset = 0;
  if (field.bit_width == 0) return out;
  out.bit_shift = out.bit_width = 0;
  if (has_whole_numbers(field) && range_of_type(field).hi <= 255) out.type = Type::u8;
  return out;
}

bool is_wide_integer(const Field& field) {
  return field.is_plain() && (field.type == Type::u64 || field.type == Type::i64);
}

/// Returns the index of the field of `common` to which field `index` of `input` is converted. If several fields have
/// one name, the n-th of them in `input` belongs to the n-th of them in `common`.
std::size_t target_of(const Schema& input, std::size_t index, const Schema& common) {
  const std::string& name = input.fields[index].name;
  const auto named = [&](const Field& field) { return field.name == name; };
  const auto begin = input.fields.begin();
  auto before = std::count_if(begin, begin + static_cast<std::ptrdiff_t>(index), named);
  std::size_t at = 0;
  while (!named(common.fields[at]) || before-- > 0) ++at;
  return at;
}

/// Returns `input` with uint64 fields read as int64 where the field is int64 in `common`: the bits of all values that
/// int64 holds are the same.
Schema with_signed_integers(Schema input, const Schema& common) {
  for (std::size_t i = 0; i < input.fields.size(); ++i) {
    Field& field = input.fields[i];
    if (field.type == Type::u64 && is_wide_integer(field) &&
        common.fields[target_of(input, i, common)].type == Type::i64)
      field.type = Type::i64;
  }
  return input;
}

/// Returns whether a value of the type `to`, int64 or float64, is exactly the integer `value`.
template <class T>
bool is_exact_in(Type to, T value) {
  if (to == Type::i64) return std::in_range<std::int64_t>(value);
  const auto real = static_cast<double>(value);
  return real < static_cast<double>(std::numeric_limits<T>::max()) && static_cast<T>(real) == value;
}

/// Widens `into` so that it also holds the values of `field`.
void widen(Field& into, const Field& field) {
  into.count = std::max(into.count, field.count);
  const Field other = unpacked(field);
  if (same_storage(into, other)) return;
  into.type = common_type(into, other);
  into.scale = 1;
  into.bias = 0;
}

/// The union of the fields of many schemas, each under its name in the first schema that has it.
class Union {
 public:
  /// Adds a schema and returns it with the names that its fields have in the union.
  Schema add(Schema schema) {
    std::vector<bool> taken(fields_.size());
    for (Field& field : schema.fields) {
      const std::string key = library_name_of(field.name);
      std::size_t i = 0;
      while (i < fields_.size() && (taken[i] || keys_[i] != key)) ++i;
      if (i == fields_.size()) {
        fields_.push_back(unpacked(field));
        ranges_.push_back(range_of_type(field));
        if (schemas_ != 0) ranges_.back().include(0);
        keys_.push_back(key);
        taken.push_back(true);
      } else {
        widen(fields_[i], field);
        ranges_[i].include(range_of_type(field));
        taken[i] = true;
      }
      field.name = fields_[i].name;
    }
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      if (!taken[i]) ranges_[i].include(0);
    }
    ++schemas_;
    return schema;
  }

  /// Returns the range of each field that the types of all inputs allow. It includes 0 if an input lacks the field.
  const std::vector<ValueRange>& ranges() const { return ranges_; }

  Schema schema() const {
    Schema schema;
    for (const Field& field : fields_) {
      const std::size_t i = schema.append(field.name, field.type, field.count);
      schema.fields[i].scale = field.scale;
      schema.fields[i].bias = field.bias;
    }
    return schema;
  }

 private:
  std::vector<Field> fields_;
  std::vector<std::string> keys_;
  std::vector<ValueRange> ranges_;
  std::size_t schemas_ = 0;
};

bool has_field(const Schema& schema, const std::string& name) {
  return std::ranges::any_of(schema.fields, [&](const Field& field) { return field.name == name; });
}

/// Returns whether `name` is a field for which point formats 0 to 5 of LAS have no bits. No warning names it: it is 0
/// for their points, except that MissingFields sets `overlap` for points of class 12.
bool is_flag_of_las14(std::string_view name) { return name == "overlap" || name == "scanner_channel"; }

/// Returns whether `field` is one of the two return numbers and the input has neither. MissingFields sets both to 1.
bool is_return_number(const Field& field, const Schema& input) {
  const std::string name = library_name_of(field.name);
  const bool has_any = input.find("return_number") || input.find("number_of_returns");
  return (name == "return_number" || name == "number_of_returns") && !has_any;
}

/// Returns "b.las: has no 'nir', which a.las has; it is 0 for its points."; empty if nothing is missing. `schemas` use
/// the names of `all`.
std::string what_is_missing(const Readers& readers, const std::vector<Schema>& schemas, std::size_t input,
                            const Schema& all) {
  std::string names;
  std::size_t missing = 0, other = 0;
  for (const Field& field : all.fields) {
    if (has_field(schemas[input], field.name) || is_flag_of_las14(field.name)) continue;
    if (is_return_number(field, readers[input]->info().schema)) continue;
    if (missing++ == 0)
      while (!has_field(schemas[other], field.name)) ++other;
    names += fmt::format("{}'{}'", names.empty() ? "" : ", ", field.name);
  }
  if (missing == 0) return "";
  return fmt::format("{}: has no {}, which {} {}; {} 0 for its points.", readers[input]->info().path.string(), names,
                     readers[other]->info().path.string(), missing == 1 ? "has" : "and others have",
                     missing == 1 ? "it is" : "they are");
}

std::vector<std::string> missing_fields(const Readers& readers, const std::vector<Schema>& schemas, const Schema& all) {
  constexpr std::size_t kMostNamed = 5;
  std::vector<std::string> warnings;
  std::size_t more = 0;
  for (std::size_t i = 0; i < readers.size(); ++i) {
    std::string warning = what_is_missing(readers, schemas, i, all);
    if (warning.empty()) continue;
    warnings.size() < kMostNamed ? warnings.push_back(std::move(warning)) : void(++more);
  }
  if (more > 0)
    warnings.push_back(fmt::format("{} more inputs lack attributes that others have; these are 0 there.", more));
  return warnings;
}

}  // namespace

MissingFields::MissingFields(const FileInfo& input, const Schema& common) {
  const char* const kReturns[] = {"return_number", "number_of_returns"};
  if (!input.schema.find(kReturns[0]) && !input.schema.find(kReturns[1])) {
    for (const char* name : kReturns)
      if (const auto at = common.find(name)) ones_.push_back(common.fields[*at]);
  }
  const auto overlap = common.find("overlap"), classification = common.find("classification");
  if (overlap && classification && input.las && input.las->overlap_is_class_12)
    overlap_.emplace(common.fields[*classification], common.fields[*overlap]);
}

void MissingFields::run(std::span<std::byte> records, std::size_t stride) const {
  for (std::size_t at = 0; at + stride <= records.size(); at += stride) {
    std::byte* const record = records.data() + at;
    for (const Field& field : ones_) set_value(field, record, 1);
    if (overlap_ && value_of(overlap_->first, record) == kOverlapClass) set_value(overlap_->second, record, 1);
  }
}

WideIntegers::WideIntegers(const Schema& input, const Schema& common) {
  for (std::size_t i = 0; i < input.fields.size(); ++i) {
    const Field& from = input.fields[i];
    if (!is_wide_integer(from)) continue;
    const std::size_t index = target_of(input, i, common);
    const Type to = common.fields[index].type;
    if (to != from.type) narrowed_.push_back({from, index, to});
  }
}

std::optional<WideIntegers::Loss> WideIntegers::first_loss(std::span<const std::byte> records, std::size_t stride,
                                                           const WantedFields& wanted) const {
  std::vector<Narrowed> read;
  std::ranges::copy_if(narrowed_, std::back_inserter(read), [&](const Narrowed& field) {
    return wanted.empty() || std::ranges::find(wanted, field.index) != wanted.end();
  });
  const std::size_t rows = read.empty() ? 0 : records.size() / stride;
  for (std::size_t row = 0; row < rows; ++row)
    for (const auto& [from, index, to] : read)
      for (std::uint32_t c = 0; c < from.count; ++c) {
        const std::int64_t value = whole_number_of(from, records.data() + row * stride, c);
        const bool is_signed = from.type == Type::i64;
        if (is_signed ? is_exact_in(to, value) : is_exact_in(to, static_cast<std::uint64_t>(value))) continue;
        return Loss{row, from.name,
                    is_signed ? std::to_string(value) : std::to_string(static_cast<std::uint64_t>(value)), to};
      }
  return std::nullopt;
}

CommonSchema common_schema(const Readers& readers) {
  for (const auto& reader : readers) position_fields(reader->info().schema, reader->info().path.string());
  const std::optional<CommonGrid> grid = common_grid(readers);
  CommonSchema common;
  std::vector<Schema> schemas;
  for (std::size_t i = 0; i < readers.size(); ++i) {
    const Schema& schema = readers[i]->info().schema;
    common.mappings.push_back({grid ? grid->shifts[i] : GridShift{}, nullptr});
    schemas.push_back(grid ? on_grid(schema, grid->grid) : schema);
  }
  common.schema = schemas.front();
  if (std::ranges::all_of(schemas, [&](const Schema& s) { return s == common.schema; })) {
    for (const Field& field : common.schema.fields) common.ranges.push_back(range_of_type(field));
    return common;
  }

  const bool numbered = has_input_row(common.schema);
  Union all;
  for (Schema& schema : schemas) schema = all.add(without_input_row(std::move(schema)));
  common.schema = all.schema();
  common.ranges = all.ranges();
  if (numbered) {
    for (Schema& schema : schemas) schema = with_input_row(std::move(schema));
    common.schema = with_input_row(std::move(common.schema));
    common.ranges.push_back(range_of_type(common.schema.fields.back()));
  }
  common.warnings = missing_fields(readers, schemas, common.schema);
  std::vector<std::string> brightened;
  for (std::size_t i = 0; i < readers.size(); ++i) {
    const std::optional<Schema> scaled = has_wide_colors(common.schema) ? with_wide_colors(schemas[i]) : std::nullopt;
    if (scaled) brightened.push_back(readers[i]->info().path.string());
    common.mappings[i].conversion = std::make_unique<RecordConversion>(
        with_signed_integers(scaled ? *scaled : schemas[i], common.schema), common.schema);
    common.mappings[i].missing = MissingFields(readers[i]->info(), common.schema);
    common.mappings[i].wide = WideIntegers(schemas[i], common.schema);
  }
  if (!brightened.empty())
    common.warnings.push_back(fmt::format(
        "{}{}: red, green and blue of 8 bits are read as 16 bits, times 257, since other inputs have 16 bits.",
        brightened.front(), brightened.size() == 1 ? "" : fmt::format(" and {} more inputs", brightened.size() - 1)));
  return common;
}

}  // namespace pointsweep
