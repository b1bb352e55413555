// SPDX-License-Identifier: MIT
/// Attributes of points, which operators read and make, and the layout of records in memory (paper Section 5.1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pointsweep/export.h"

namespace pointsweep {

/// The type of a number: a signed or unsigned integer or an IEEE floating-point number, with its number of bits.
enum class Type : std::uint8_t { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

/// Returns the size of one number of a type in bytes.
POINTSWEEP_EXPORT std::size_t size_of(Type type);
/// Returns the name of a type: "int8", "uint8", ..., "float64".
POINTSWEEP_EXPORT std::string_view name_of(Type type);

/// The way in which a value changes when the cloud is rotated, translated or scaled.
enum class Kind : std::uint8_t { position, vector, normal, scalar, index, color };

/// One attribute of a point, e.g. {"normal", f32, kind normal, fields {"nx","ny","nz"}, unit "1", "unit surface normal
/// ..."}. A column of an attribute holds `fields.size()` values of `type` for each point, interleaved.
struct Attribute {
  std::string name;
  Type type = Type::f32;
  Kind kind = Kind::scalar;
  std::vector<std::string> fields;  ///< for each component, the library's name of its field in files
  std::string unit;                 ///< unit of the values: "1", "length", "1/length", ...
  std::string meaning;              ///< meaning of the values, as a phrase for people
  /// Value of each byte of the attribute in a row without a result: for a point with non-finite coordinates, unless the
  /// stage reads only the point itself, and for a row about which an in-order operator finds nothing.
  std::byte fill{0};

  std::size_t bytes() const { return size_of(type) * fields.size(); }
  /// Returns whether the attribute is a list of m values, stored as N×m even if m is 1, and not a scalar.
  bool is_list() const { return fields.size() != 1 || fields.front() != name; }
};

/// Makes a scalar attribute whose only field has the attribute's name.
inline Attribute scalar(std::string name, Type type, std::string unit, std::string meaning) {
  return {name, type, Kind::scalar, {name}, std::move(unit), std::move(meaning)};
}

/// The unit surface normal, N×3 f32; (0, 0, 0) if undefined.
inline Attribute normal_attribute() {
  return {"normal", Type::f32, Kind::normal, {"nx", "ny", "nz"}, "1", "unit surface normal; 0 where undefined"};
}

/// The position, N×3 f64. An operator that makes it moves the points: stages after it see the new positions of a point
/// and of its neighbours, but neighbourhoods and order stay as in the input until Reneighbor and Resort.
inline Attribute position_attribute() {
  return {"position", Type::f64, Kind::position, {"x", "y", "z"}, "length", "moved position"};
}

/// A named value inside a record, or `count` values of one type side by side. value = bits(raw) * scale + bias, where
/// bits() takes `bit_width` bits from `bit_shift` on, or all bits if `bit_width` is 0.
struct Field {
  std::string name;  ///< name in the file
  Type type = Type::f32;
  std::uint32_t offset = 0;  ///< bytes from the start of the record
  std::uint32_t count = 1;
  std::uint8_t bit_shift = 0;
  std::uint8_t bit_width = 0;
  double scale = 1;
  double bias = 0;

  bool is_plain() const { return bit_width == 0 && scale == 1 && bias == 0; }
  friend bool operator==(const Field&, const Field&) = default;
};

/// The layout of points in memory: one record of `stride` bytes for each point, in the byte order of the machine. Bytes
/// outside of all fields are kept, too.
struct POINTSWEEP_EXPORT Schema {
  std::vector<Field> fields;
  std::uint32_t stride = 0;  ///< bytes of a record, in which all fields lie; fields may share bytes

  /// Returns the index of the field for `name`, which is one of the library's own names ("x", "nx", "intensity", ...).
  /// The field may have any spelling that files use ("normal_x", "NormalX"), in upper or lower case.
  std::optional<std::size_t> find(std::string_view name) const;
  /// Appends a field after the present record and returns its index.
  std::size_t append(std::string name, Type type, std::uint32_t count = 1);
  friend bool operator==(const Schema&, const Schema&) = default;
};

/// Returns the value of element `component` of `field` in the record at `record`, as a double; 64-bit integers may
/// round.
POINTSWEEP_EXPORT double value_of(const Field& field, const std::byte* record, std::uint32_t component = 0);
/// Stores `value` in element `component` of `field` in the record: subtracts the bias, divides by the scale, and for
/// integers rounds to nearest and saturates at the ends of the type or of the bits of the field; NaN becomes 0 in
/// integers.
POINTSWEEP_EXPORT void set_value(const Field& field, std::byte* record, double value, std::uint32_t component = 0);

}  // namespace pointsweep
