// SPDX-License-Identifier: MIT
#include "pointsweep/points/schema.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <type_traits>

#include "pointsweep/points/with_type.h"

namespace pointsweep {
namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool same_word(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char p, char q) { return lower(p) == lower(q); });
}

std::uint64_t mask_of(const Field& field) {
  return field.bit_width >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << field.bit_width) - 1;
}

/// Returns the integer of type T that is nearest to `value`; 0 for NaN.
template <class T>
T saturate(double value) {
  if (std::isnan(value)) return 0;
  const double rounded = std::nearbyint(value);
  if (rounded <= static_cast<double>(std::numeric_limits<T>::min())) return std::numeric_limits<T>::min();
  if (rounded >= static_cast<double>(std::numeric_limits<T>::max())) return std::numeric_limits<T>::max();
  return static_cast<T>(rounded);
}

template <class T>
double load_value(const Field& field, const std::byte* at) {
  T raw;
  std::memcpy(&raw, at, sizeof raw);
  double bits = static_cast<double>(raw);
  if constexpr (std::is_integral_v<T>) {
    if (field.bit_width != 0) {
      const auto word = static_cast<std::uint64_t>(static_cast<std::make_unsigned_t<T>>(raw));
      bits = static_cast<double>(word >> field.bit_shift & mask_of(field));
    }
  }
  return field.scale == 1 && field.bias == 0 ? bits : bits * field.scale + field.bias;
}

/// Returns the number, not yet rounded, with which `field` stores `value`.
double raw_number(const Field& field, double value) {
  return field.scale == 1 && field.bias == 0 ? value : (value - field.bias) / field.scale;
}

/// Returns the word `old` with `bits`, rounded and saturated, in the bits of `field`.
template <class T>
T with_bits(const Field& field, T old, double bits) {
  using Word = std::make_unsigned_t<T>;
  const std::uint64_t mask = mask_of(field);
  const std::uint64_t chosen = std::min(saturate<std::uint64_t>(bits), mask);
  const std::uint64_t kept = static_cast<std::uint64_t>(static_cast<Word>(old)) & ~(mask << field.bit_shift);
  return static_cast<T>(static_cast<Word>(kept | chosen << field.bit_shift));
}

template <class T>
void store_value(const Field& field, std::byte* at, double value) {
  const double bits = raw_number(field, value);
  T raw;
  if constexpr (std::is_floating_point_v<T>) {
    raw = static_cast<T>(bits);
  } else if (field.bit_width == 0) {
    raw = saturate<T>(bits);
  } else {
    std::memcpy(&raw, at, sizeof raw);
    raw = with_bits(field, raw, bits);
  }
  std::memcpy(at, &raw, sizeof raw);
}

/// Returns whether `field`, which is a word of type T or some bits of such a word, can hold a rounded value.
template <class T>
bool is_in_range(const Field& field, double rounded) {
  if (field.bit_width != 0) return rounded >= 0 && rounded <= static_cast<double>(mask_of(field));
  // The largest 64-bit integer is not a double: its conversion rounds up to the next integer, which is out of range.
  constexpr auto kMost = static_cast<double>(std::numeric_limits<T>::max());
  const bool below = sizeof(T) < 8 ? rounded <= kMost : rounded < kMost;
  return rounded >= static_cast<double>(std::numeric_limits<T>::min()) && below;
}

}  // namespace

std::size_t bytes_of(const std::vector<Attribute>& attributes) {
  return std::accumulate(attributes.begin(), attributes.end(), std::size_t{0},
                         [](std::size_t sum, const Attribute& a) { return sum + a.bytes(); });
}

bool holds(const Field& field, double value) {
  const double bits = raw_number(field, value);
  return with_type(field.type, [&]<class T>() {
    if constexpr (std::is_floating_point_v<T>)
      return !std::isfinite(bits) || std::isfinite(static_cast<T>(bits));
    else
      return is_in_range<T>(field, std::nearbyint(bits));
  });
}

bool holds_all_of(const Field& field, const Field& values) {
  const auto is_real = [](Type type) { return type == Type::f32 || type == Type::f64; };
  if (is_real(field.type)) return field.type == Type::f64 || values.type != Type::f64;
  if (is_real(values.type) || values.scale != 1 || values.bias != 0) return false;
  return with_type(values.type, [&]<class T>() {
    using Limits = std::numeric_limits<T>;
    if (values.bit_width != 0) return holds(field, 0) && holds(field, static_cast<double>(mask_of(values)));
    return holds(field, static_cast<double>(Limits::min())) && holds(field, static_cast<double>(Limits::max()));
  });
}

Type unpacked_type(const Field& field) {
  if (field.bit_width == 0) return field.type;
  return field.bit_width <= 8    ? Type::u8
         : field.bit_width <= 16 ? Type::u16
         : field.bit_width <= 32 ? Type::u32
                                 : Type::u64;
}

std::size_t size_of(Type type) {
  return with_type(type, []<class T>() { return sizeof(T); });
}

std::string_view name_of(Type type) {
  static constexpr std::string_view kNames[] = {"int8",   "uint8", "int16",  "uint16",  "int32",
                                                "uint32", "int64", "uint64", "float32", "float64"};
  return kNames[static_cast<std::size_t>(type)];
}

std::optional<std::size_t> Schema::find(std::string_view name) const {
  for (const std::string& spelling : spellings_of(name)) {
    const auto found =
        std::find_if(fields.begin(), fields.end(), [&](const Field& field) { return same_word(field.name, spelling); });
    if (found != fields.end()) return static_cast<std::size_t>(found - fields.begin());
  }
  return std::nullopt;
}

std::size_t Schema::append(std::string name, Type type, std::uint32_t count) {
  Field field;
  field.name = std::move(name);
  field.type = type;
  field.offset = stride;
  field.count = count;
  fields.push_back(std::move(field));
  stride += static_cast<std::uint32_t>(size_of(type) * count);
  return fields.size() - 1;
}

double value_of(const Field& field, const std::byte* record, std::uint32_t component) {
  return with_type(field.type,
                   [&]<class T>() { return load_value<T>(field, record + field.offset + component * sizeof(T)); });
}

void set_value(const Field& field, std::byte* record, double value, std::uint32_t component) {
  with_type(field.type,
            [&]<class T>() { store_value<T>(field, record + field.offset + component * sizeof(T), value); });
}

bool has_whole_numbers(const Field& field) {
  return field.type != Type::f32 && field.type != Type::f64 && field.scale == 1 && field.bias == 0;
}

std::int64_t whole_number_of(const Field& field, const std::byte* record, std::uint32_t component) {
  if (!field.is_plain()) return static_cast<std::int64_t>(value_of(field, record, component));
  return with_type(field.type, [&]<class T>() {
    T value;
    std::memcpy(&value, record + field.offset + component * sizeof value, sizeof value);
    return static_cast<std::int64_t>(value);
  });
}

}  // namespace pointsweep
