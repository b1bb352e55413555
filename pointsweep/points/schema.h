// SPDX-License-Identifier: MIT
/// Spellings of field names, decoding of coordinates, values that a field can hold, and conversion of records between
/// schemas. Records keep the bytes of a binary file in this machine's byte order, so that attributes that no stage uses
/// pass through unchanged (the paper's InputFields, Section 5.1).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/attribute.h"

namespace pointsweep {

/// The library's names of the coordinate fields.
inline constexpr std::array<const char*, 3> kAxisNames{"x", "y", "z"};
/// Returns the bytes that the values of these attributes take for one point.
std::size_t bytes_of(const std::vector<Attribute>& attributes);

/// Returns every name under which files store the library's field `name`, in the order in which Schema::find() tries
/// these names, e.g. for "nx": nx, normal_x, normalx, "normal x", normal.x. A name without known aliases is its only
/// spelling.
std::vector<std::string> spellings_of(std::string_view name);
/// Returns every word by which a user may name the field `name`: its spellings in files, and its names in other
/// programs.
std::vector<std::string> words_for(std::string_view name);
/// Returns the names of the library's fields for which words_for() returns several words.
std::vector<std::string> names_with_spellings();
/// Returns the library's own name for the field that a file calls `spelling`, in upper or lower case. If `spelling` is
/// no known alias, returns `spelling` in lower case.
std::string library_name_of(std::string_view spelling);
/// Returns whether `word`, in upper or lower case, is one of the words by which a user may name `field`.
bool is_spelling_of(std::string_view field, std::string_view word);
/// Returns whether `word`, in upper or lower case, is `field`, or a spelling that library_name_of() turns into `field`
/// and that is not itself the name of a field with spellings. So "curvature", which is the surface variation in PCL but
/// another quantity in other programs, does not mean "surface_variation".
bool means_only(std::string_view word, std::string_view field);
/// Returns the index of the field that a user means by `word`: the field with exactly this name; else a field whose
/// name is another spelling of `word`, in upper or lower case; else the field that other programs call `word`. Returns
/// nullopt if the schema has none of these fields.
std::optional<std::size_t> field_meant(const Schema& schema, std::string_view word);

/// The three coordinate fields of a schema.
struct PositionFields {
  Field x, y, z;
};
/// Returns the coordinate fields. Throws Error if the schema lacks x, y or z. `where`: beginning of the message, such
/// as the path of the file.
PositionFields position_fields(const Schema& schema, std::string_view where);

/// Decodes `count` positions from records `stride` bytes apart into three arrays. About 1 ns per point.
void decode_positions(const PositionFields& fields, const std::byte* records, std::size_t stride, std::size_t count,
                      double* x, double* y, double* z);

/// Returns the type that holds a raw value of `field` in a word of its own: the type of `field`, or for a field of
/// `bit_width` bits, the smallest unsigned type with so many bits.
Type unpacked_type(const Field& field);

/// Returns whether `field` can store `value`. A field of integers or bits stores a value if (value - bias) / scale
/// rounds to a number in its range, but no NaN or infinity. A field of floats stores every value, unless a finite value
/// would become infinite.
bool holds(const Field& field, double value);

/// Returns whether `field` can store every value of the field `values`, though perhaps rounded. A field of floats can,
/// except f32 for values of f64. A field of integers or bits can if `values` has unscaled integers and holds() is true
/// for the least and the greatest of these integers.
bool holds_all_of(const Field& field, const Field& values);

/// Returns whether the values of `field` are whole numbers: integers without scale and bias.
bool has_whole_numbers(const Field& field);

/// Returns a value of a field for which has_whole_numbers() is true. An unsigned value of 2^63 or more becomes
/// negative, with the same bits. A field of bits is exact up to 53 bits.
std::int64_t whole_number_of(const Field& field, const std::byte* record, std::uint32_t component = 0);

/// Copies records of one schema into records of another, field by field. A field with the same type, scale and bias in
/// both, and without bits, is copied bit for bit; otherwise its values are converted. The bytes of fields absent in
/// `from` become 0.
class RecordConversion {
 public:
  RecordConversion(const Schema& from, const Schema& to);
  void run(const std::byte* from, std::byte* to, std::size_t count) const;
  bool is_identity() const { return identity_; }

 private:
  struct Step {
    Field from, to;
    bool bitwise;  ///< true if `from` and `to` are fields of Field::count bytes to copy
  };
  std::vector<Step> steps_;
  std::uint32_t from_stride_, to_stride_;
  bool identity_;
};

}  // namespace pointsweep
