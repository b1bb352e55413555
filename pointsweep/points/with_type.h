// SPDX-License-Identifier: MIT
/// Dispatch from a Type known at run time to a template for the C++ type.
#pragma once

#include <cstdint>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Calls `f.template operator()<T>()` with the C++ type that `type` names.
template <class F>
decltype(auto) with_type(Type type, F&& f) {
  switch (type) {
    case Type::i8:
      return f.template operator()<std::int8_t>();
    case Type::u8:
      return f.template operator()<std::uint8_t>();
    case Type::i16:
      return f.template operator()<std::int16_t>();
    case Type::u16:
      return f.template operator()<std::uint16_t>();
    case Type::i32:
      return f.template operator()<std::int32_t>();
    case Type::u32:
      return f.template operator()<std::uint32_t>();
    case Type::i64:
      return f.template operator()<std::int64_t>();
    case Type::u64:
      return f.template operator()<std::uint64_t>();
    case Type::f32:
      return f.template operator()<float>();
    case Type::f64:
      break;
  }
  return f.template operator()<double>();
}

}  // namespace pointsweep
