// SPDX-License-Identifier: MIT
#include "pointsweep/operators/expressions/named_values.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "pointsweep/fail.h"
#include "pointsweep/points/input_row.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/points/with_type.h"

namespace pointsweep {
namespace {

/// Returns the first component, among those of all made attributes but the position, for whose name `fits` returns
/// true.
template <class Fits>
MeantValue made_value(std::span<const Attribute> made, Fits fits) {
  for (const Attribute& a : made) {
    const auto field = std::ranges::find_if(a.fields, fits);
    if (a.name != position_attribute().name && field != a.fields.end())
      return {.made = &a, .component = static_cast<std::size_t>(field - a.fields.begin())};
  }
  return {};
}

bool is_64_bits(Type type) { return type == Type::i64 || type == Type::u64; }

/// Returns the names that an expression may use, each once.
std::string names_of(const Schema& input, std::span<const Attribute> made) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& attribute) {
    const std::string name = spelled_name(attribute);
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  };
  for (const Field& field : input.fields)
    if (field.count == 1) add(field.name == kInputRow ? kRowWord : field.name);
  for (const Attribute& a : made)
    for (const std::string& field : a.fields) add(field);
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

MeantValue meant_value(const std::string& word, const Schema& input, std::span<const Attribute> made) {
  const auto is_word = [&](const std::string& field) { return field == word; };
  if (const MeantValue own = made_value(made, is_word); own.made != nullptr) return own;
  const auto is_meant = [&](const std::string& field) { return means_only(word, field); };
  if (const MeantValue own = made_value(made, is_meant); own.made != nullptr) return own;
  const auto at = field_meant(input, word);
  if (at && input.fields[*at].name == word) return {.field = &input.fields[*at]};
  const auto is_spelled = [&](const std::string& field) { return is_spelling_of(field, word); };
  if (const MeantValue own = made_value(made, is_spelled); own.made != nullptr) return own;
  return {.field = at ? &input.fields[*at] : nullptr};
}

MeantValue value_in_expression(const std::string& word, const Schema& input, std::span<const Attribute> made) {
  const MeantValue own = meant_value(word, input, made);
  if (own.made != nullptr || own.field != nullptr || word != kRowWord) return own;
  return meant_value(kInputRow, input, made);
}

Expression expression_of_attribute(const std::string& name, const std::string& place, const Schema& input,
                                   std::span<const Attribute> made) {
  const MeantValue meant = meant_value(name, input, made);
  const bool is_known = meant.made != nullptr || meant.field != nullptr;
  return Expression(is_known ? spelled_name(name) : name, place, Expression::Form::number);
}

std::optional<std::size_t> axis_of(std::string_view name) {
  const auto at = std::ranges::find(kAxisNames, library_name_of(name));
  if (at == kAxisNames.end()) return std::nullopt;
  return static_cast<std::size_t>(at - kAxisNames.begin());
}

bool makes(std::span<const Attribute> made, std::string_view name) {
  return std::ranges::find(made, name, &Attribute::name) != made.end();
}

Type type_of_values(const Field& field) {
  return field.scale == 1 && field.bias == 0 ? unpacked_type(field) : Type::f64;
}

std::optional<Attribute> single_value(const char* name, const Schema& input, std::span<const Attribute> made) {
  const auto own =
      std::ranges::find_if(made, [&](const Attribute& a) { return a.name == name && a.fields.size() == 1; });
  if (own != made.end()) return *own;
  const auto at = input.find(name);
  if (!at || input.fields[*at].count != 1) return {};
  return scalar(input.fields[*at].name, Type::f64, "1", name);
}

std::string TargetRange::text() const {
  if (!is_whole) return std::string(name_of(type));
  if (most < 0x1p53) return fmt::format("{}, {:.0f} to {:.0f}", name_of(type), least, most);
  return with_type(type, [&]<class T>() {  // float64 does not hold the greatest integer of 64 bits
    return fmt::format("{}, {} to {}", name_of(type), std::numeric_limits<T>::min(), std::numeric_limits<T>::max());
  });
}

TargetRange range_of(Type type) {
  return with_type(type, [&]<class T>() {
    if constexpr (std::is_floating_point_v<T>) return TargetRange{.type = type};
    return TargetRange{.type = type,
                       .least = static_cast<double>(std::numeric_limits<T>::min()),
                       .most = static_cast<double>(std::numeric_limits<T>::max()),
                       .is_whole = true};
  });
}

TargetRange range_of(const Field& field) {
  TargetRange range = range_of(type_of_values(field));
  if (range.is_whole && field.bit_width > 0 && field.bit_width < 53) range.most = std::ldexp(1.0, field.bit_width) - 1;
  return range;
}

std::optional<AssignedTarget> target_of(const std::string& name, const Schema& input, std::span<const Attribute> made,
                                        const std::string& place) {
  const MeantValue meant = meant_value(name, input, made);
  if (meant.made != nullptr)
    return AssignedTarget{*meant.made, meant.component, range_of(meant.made->type), *meant.made};
  if (makes(made, name)) fail_usage("{}: '{}' has several components; name one of them.", place, name);
  if (meant.field == nullptr) return std::nullopt;
  const Field& field = *meant.field;
  if (field.count != 1) fail_usage("{}: '{}' is an array of {}, not a single value.", place, field.name, field.count);
  const TargetRange range = range_of(field);
  const bool exact = field.is_plain() && (field.type == Type::i64 || field.type == Type::u64);
  return AssignedTarget{scalar(field.name, range.type, "1", "assigned"), 0, range,
                        scalar(field.name, exact ? field.type : Type::f64, "", "")};
}

NamedValues::NamedValues(const Expression& expression, const std::string& place, const Schema& input,
                         std::span<const Attribute> made) {
  const auto refuse = [&](const Expression::Name& name, const std::string& what) {
    fail_usage("{}: '{}', column {}: {}.", place, expression.text(), name.column, what);
  };
  const auto source_of = [&](const Expression::Name& name) -> Source {
    const MeantValue meant = value_in_expression(name.text, input, made);
    if (meant.made != nullptr) return read(*meant.made, meant.component);
    if (const auto axis = axis_of(name.text)) return {-1, *axis};
    for (const Attribute& a : made)
      if (a.name == name.text)
        refuse(name, fmt::format("'{}' has the components {}; name one of these", a.name, fmt::join(a.fields, ", ")));
    if (meant.field == nullptr && library_name_of(name.text) == "classflags")
      refuse(name, "ClassFlags are four attributes here: synthetic, key_point, withheld and overlap");
    if (meant.field == nullptr)
      refuse(name, fmt::format("there is no attribute '{}'; there are {}", name.text, names_of(input, made)));
    const Field& field = *meant.field;
    if (field.count != 1)
      refuse(name,
             fmt::format("'{}' is an array of {}, and a condition compares single values", name.text, field.count));
    const bool exact = field.is_plain() && is_64_bits(field.type);
    return read(scalar(field.name, exact ? field.type : Type::f64, "", ""), 0);
  };
  for (const Expression::Name& name : expression.names()) sources_.push_back(source_of(name));
}

NamedValues::Source NamedValues::read(Attribute attribute, std::size_t component) {
  const auto known = std::ranges::find(reads_, attribute.name, &Attribute::name);
  const auto index = static_cast<int>(known - reads_.begin());
  if (known == reads_.end()) reads_.push_back(std::move(attribute));
  return {index, component};
}

NamedValues::Batch::Batch(const NamedValues& names, const Neighborhoods& in, std::size_t first) {
  take(
      names, in.size(), [&](std::size_t i) { return in.position(i); },
      [&](std::size_t a, std::size_t i, std::size_t bytes) { return in.values<std::byte>(first + a) + i * bytes; });
}

NamedValues::Batch::Batch(const NamedValues& names, const Neighborhoods& in, std::size_t first,
                          std::span<const NeighborRef> neighbors) {
  take(
      names, neighbors.size(), [&](std::size_t i) { return in.position_of(neighbors[i]); },
      [&](std::size_t a, std::size_t i, std::size_t bytes) {
        const NeighborRef ref = neighbors[i];
        return in.values_of_slot<std::byte>(first + a, slot_of(ref)) + index_of(ref) * bytes;
      });
}

template <class Position, class Record>
void NamedValues::Batch::take(const NamedValues& names, std::size_t count, Position position, Record record) {
  memory_.resize(names.sources_.size());
  for (std::size_t n = 0; n < names.sources_.size(); ++n) {
    const Source source = names.sources_[n];
    Memory& out = memory_[n];
    if (source.attribute < 0) {
      out.real.resize(count);
      for (std::size_t i = 0; i < count; ++i) out.real[i] = position(i)[static_cast<int>(source.component)];
      values_.push_back({.real = out.real.data()});
      continue;
    }
    const auto number = static_cast<std::size_t>(source.attribute);
    const Attribute& attribute = names.reads_[number];
    with_type(attribute.type, [&]<class T>() {
      const auto copy = [&](auto& values) {
        values.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
          T value;
          std::memcpy(&value, record(number, i, attribute.bytes()) + source.component * sizeof(T), sizeof(T));
          values[i] = static_cast<std::remove_reference_t<decltype(values[i])>>(value);
        }
        return values.data();
      };
      if constexpr (std::is_integral_v<T> && sizeof(T) == 8)
        values_.push_back({.whole = copy(out.whole), .is_signed = std::is_signed_v<T>});
      else
        values_.push_back({.real = copy(out.real)});
    });
  }
}

}  // namespace pointsweep
