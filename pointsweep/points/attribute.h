// SPDX-License-Identifier: MIT
/// Attributes: what operators read and make, and what files hold (paper Section 5.1).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// What a rotation, translation or scaling of the cloud does to a value.
enum class Kind : std::uint8_t { position, vector, normal, scalar, index, color };

/// One attribute of a point, e.g. {"normal", f32, kind normal, fields {"nx","ny","nz"}, unit "1", "unit surface normal
/// ..."}. A column of it holds `fields.size()` values of `type` for each point, interleaved.
struct Attribute {
  std::string name;
  Type type = Type::f32;
  Kind kind = Kind::scalar;
  std::vector<std::string> fields;  ///< the library's name of each component in files
  std::string unit;
  std::string meaning;
  std::byte fill{0};  ///< every byte of the value of a point that has none (its coordinates are not finite)

  std::size_t bytes() const { return size_of(type) * fields.size(); }
  /// A list of m values, stored as N×m even where m is 1; otherwise a scalar.
  bool is_list() const { return fields.size() != 1 || fields.front() != name; }
};

/// A scalar attribute whose only field bears its own name.
inline Attribute scalar(std::string name, Type type, std::string unit, std::string meaning) {
  return {name, type, Kind::scalar, {name}, std::move(unit), std::move(meaning)};
}

/// The unit surface normal, N×3 f32; (0, 0, 0) where none can be computed.
inline Attribute normal_attribute() {
  return {"normal", Type::f32, Kind::normal, {"nx", "ny", "nz"}, "1", "unit surface normal; 0 where undefined"};
}

/// The position, N×3 f64. An operator that makes it moves the points: stages after it see the new positions of a point
/// and of its neighbours, while neighbourhoods and order stay those of the input until they are made again.
inline Attribute position_attribute() {
  return {"position", Type::f64, Kind::position, {"x", "y", "z"}, "length", "moved position"};
}

}  // namespace pointsweep
