// SPDX-License-Identifier: MIT
#include "pointsweep/operators/expressions/meant_value.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "pointsweep/fail.h"
#include "pointsweep/points/input_row.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/points/with_type.h"

namespace pointsweep {
namespace {

/// Returns the component of a made attribute whose name `fits`.
template <class Fits>
MeantValue made_value(std::span<const Attribute> made, Fits fits) {
  for (const Attribute& a : made) {
    const auto field = std::ranges::find_if(a.fields, fits);
    if (a.name != position_attribute().name && field != a.fields.end())
      return {.made = &a, .component = static_cast<std::size_t>(field - a.fields.begin())};
  }
  return {};
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
  return with_type(type, [&]<class T>() {  // the greatest integers of 64 bits are no doubles
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

}  // namespace pointsweep
