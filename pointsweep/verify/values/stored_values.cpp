// SPDX-License-Identifier: MIT
#include "pointsweep/verify/values/stored_values.h"

#include <algorithm>
#include <cstring>

#include "pointsweep/points/with_type.h"

namespace pointsweep {

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

}  // namespace pointsweep
