// SPDX-License-Identifier: MIT
#include "pointsweep/points/whole_numbers.h"

#include <cstring>

#include "pointsweep/points/with_type.h"

namespace pointsweep {

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
