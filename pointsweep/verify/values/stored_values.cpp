// SPDX-License-Identifier: MIT
#include "pointsweep/verify/values/stored_values.h"

#include <algorithm>
#include <cstring>

#include "pointsweep/points/with_type.h"

namespace pointsweep {
namespace {

/// Stores a number, converted once to its type; a fraction is cut off for u64, i64 and u32.
void put_number(Type type, formulas::Real number, std::byte* to) {
  const auto copy = [to](auto value) { std::memcpy(to, &value, sizeof value); };
  if (type == Type::f32) return copy(static_cast<float>(number));
  if (type == Type::f64) return copy(static_cast<double>(number));
  if (type == Type::u64) return copy(static_cast<std::uint64_t>(number));
  if (type == Type::i64) return copy(static_cast<std::int64_t>(number));
  if (type == Type::u32) return copy(static_cast<std::uint32_t>(number));
  set_value({.name = "", .type = type}, to, static_cast<double>(number));
}

}  // namespace

void put_value(const Field& field, const std::byte* record, Type type, std::byte* to) {
  if (field.is_plain() && field.type == type) return void(std::copy_n(record + field.offset, size_of(type), to));
  set_value({.name = "", .type = type}, to, value_of(field, record));
}

formulas::Real number_in(Type type, const std::byte* value, std::size_t component) {
  return with_type(type, [&]<class T>() {
    T number;
    std::memcpy(&number, value + component * sizeof number, sizeof number);
    return static_cast<formulas::Real>(number);
  });
}

void put_estimates(const Attribute& a, const formulas::Estimate* estimates, std::byte* to) {
  const std::size_t components = a.fields.size();
  for (std::size_t c = 0; c < components; ++c)
    put_number(a.type, components <= 3 ? estimates->value[c] : estimates[c].value.x, to + c * size_of(a.type));
}

formulas::Storage storage_of(Type type) {
  if (type == Type::f32) return formulas::Storage::single;
  return type == Type::f64 ? formulas::Storage::real : formulas::Storage::whole;
}

}  // namespace pointsweep
