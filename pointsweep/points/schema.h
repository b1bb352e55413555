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

/// The names of the coordinates in every schema.
inline constexpr std::array<const char*, 3> kAxisNames{"x", "y", "z"};
/// Returns the bytes that the values of these attributes take for one point.
std::size_t bytes_of(const std::vector<Attribute>& attributes);

/// Returns every spelling under which files hold the library's attribute field `name`, best first, e.g. for "nx": nx,
/// normal_x, normalx, "normal x". A name without known aliases is its only spelling.
std::vector<std::string> spellings_of(std::string_view name);
/// Returns every word by which a user may name the attribute field `name`: its spellings, and the words of other
/// programs for it.
std::vector<std::string> words_for(std::string_view name);
/// Returns the names of the library's attribute fields that have several words.
std::vector<std::string> names_with_spellings();
/// Returns the library's own name for the attribute that a file calls `spelling`, in any case; `spelling` in lower case
/// if it is no known alias.
std::string library_name_of(std::string_view spelling);
/// Returns whether `word`, in any case, is one of the words by which a user may name the attribute `field`.
bool is_spelling_of(std::string_view field, std::string_view word);
/// Returns whether `word`, in any case, is a spelling of the attribute field `field` and of no other. "curvature" is a
/// spelling of the surface variation (PCL), but other programs mean other curvatures by it.
bool means_only(std::string_view word, std::string_view field);
/// Returns the index of the field that a user means by `word`: the field with exactly this name, else a field with
/// `word` as a spelling, else a field with this name in other programs. Returns nullopt if the schema has no such
/// field.
std::optional<std::size_t> field_meant(const Schema& schema, std::string_view word);

/// The three coordinate fields of a schema.
struct PositionFields {
  Field x, y, z;
};
/// Returns the coordinate fields. Throws Error, whose message names `where`, if the schema lacks x, y or z.
PositionFields position_fields(const Schema& schema, std::string_view where);

/// Decodes `count` positions from records `stride` bytes apart into three arrays. About 1 ns per point.
void decode_positions(const PositionFields& fields, const std::byte* records, std::size_t stride, std::size_t count,
                      double* x, double* y, double* z);

/// Returns the type of a field that holds the values of `field` without packing: the type of `field`, or for a field of
/// `bit_width` bits, the smallest unsigned type that is wide enough.
Type unpacked_type(const Field& field);

/// Returns whether `field` can store `value`. A field of integers or bits stores a value that is in its range after
/// rounding, but no NaN or infinity. A field of floats stores every value, unless a finite value would become infinite.
bool holds(const Field& field, double value);

/// Returns whether `field` holds every value that the type, scale and bits of the field `values` allow, and holds whole
/// numbers exactly.
bool holds_all_of(const Field& field, const Field& values);

/// Returns whether the values of the field are whole numbers: it stores integers, without scale and bias.
bool has_whole_numbers(const Field& field);

/// Returns a value of a field for which has_whole_numbers() is true, bit for bit: an unsigned value of 2^63 or more
/// becomes negative.
std::int64_t whole_number_of(const Field& field, const std::byte* record, std::uint32_t component = 0);

/// Copies records of one schema into records of another, field by field. A field with the same storage in both is
/// copied bit by bit; otherwise its value is converted. Fields absent in `from` become 0.
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
