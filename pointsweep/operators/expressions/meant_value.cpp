// SPDX-License-Identifier: MIT
#include "pointsweep/operators/expressions/meant_value.h"

#include <algorithm>

#include "pointsweep/points/input_row.h"
#include "pointsweep/points/schema.h"

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

Type type_of_values(const Field& field) {
  if (field.is_plain()) return field.type;
  if (field.bit_width == 0 || field.scale != 1 || field.bias != 0) return Type::f64;
  return field.bit_width <= 8    ? Type::u8
         : field.bit_width <= 16 ? Type::u16
         : field.bit_width <= 32 ? Type::u32
                                 : Type::u64;
}

std::optional<Attribute> single_value(const char* name, const Schema& input, std::span<const Attribute> made) {
  const auto own =
      std::ranges::find_if(made, [&](const Attribute& a) { return a.name == name && a.fields.size() == 1; });
  if (own != made.end()) return *own;
  const auto at = input.find(name);
  if (!at || input.fields[*at].count != 1) return {};
  return scalar(input.fields[*at].name, Type::f64, "1", name);
}

}  // namespace pointsweep
