// SPDX-License-Identifier: MIT
/// How the points of a file lie in memory: a record of fixed size per point, and the fields inside it.
///
/// Records keep the bytes of the file wherever the file is binary and of this machine's byte order, so that attributes
/// no stage names pass through unchanged (the paper's InputFields, Section 5.1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/math/vec3.h"

namespace pointsweep {

enum class Type : std::uint8_t { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

/// Bytes of one value.
std::size_t size_of(Type type);
/// "int8", "uint8", ... "float64".
std::string_view name_of(Type type);

/// One named value (or `count` equal ones) inside a record.
/// value = bits(raw) * scale + bias, where bits() takes `bit_width` bits from `bit_shift` on, or all if `bit_width` is
/// 0.
struct Field {
  std::string name;  ///< as the file calls it
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

struct Schema {
  std::vector<Field> fields;
  std::uint32_t stride =
      0;  ///< bytes of a record; may exceed the sum of the fields (bytes without a name are kept too)

  /// Index of the field that holds `name`, which is one of the library's own names ("x", "nx", "intensity", ...):
  /// the spellings of `spellings_of(name)` are tried in turn, upper and lower case alike.
  std::optional<std::size_t> find(std::string_view name) const;
  /// Appends a field behind the present record and returns its index.
  std::size_t append(std::string name, Type type, std::uint32_t count = 1);
  friend bool operator==(const Schema&, const Schema&) = default;
};

/// Every spelling under which files hold the library's attribute field `name`, best first, e.g. for "nx":
/// nx, normal_x, normalx, "normal x". A name without known aliases is its only spelling.
std::vector<std::string> spellings_of(std::string_view name);
/// The library's own name for what a file calls `spelling`, in any case; `spelling` in lower case if it is no known
/// alias.
std::string library_name_of(std::string_view spelling);

/// Value of element `component` of `field` in the record at `record`, as a double (64-bit integers may round).
double value_of(const Field& field, const std::byte* record, std::uint32_t component = 0);
/// Stores `value` there: divides out scale and bias, rounds to nearest for integers and saturates at the type's ends.
void set_value(const Field& field, std::byte* record, double value, std::uint32_t component = 0);

/// The three coordinate fields of a schema.
struct PositionFields {
  Field x, y, z;
};
/// Throws Error naming `where` when the schema has no x, y and z.
PositionFields position_fields(const Schema& schema, std::string_view where);

/// Decodes `count` positions from records `stride` bytes apart into three arrays. About 1 ns per point.
void decode_positions(const PositionFields& fields, const std::byte* records, std::size_t stride, std::size_t count,
                      double* x, double* y, double* z);

/// Copies records of one schema into records of another, field by field. A field whose storage is the same in both is
/// copied bit for bit; otherwise its value is converted; fields absent in `from` become 0.
class RecordConversion {
 public:
  RecordConversion(const Schema& from, const Schema& to);
  void run(const std::byte* from, std::byte* to, std::size_t count) const;
  bool is_identity() const { return identity_; }

 private:
  struct Step {
    Field from, to;
    bool bitwise;
  };
  std::vector<Step> steps_;
  std::uint32_t from_stride_, to_stride_;
  bool identity_;
};

}  // namespace pointsweep
