// SPDX-License-Identifier: MIT
/// Comparison of values in records of an input and of an output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/math/mix.h"
#include "pointsweep/points/decimals.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/verify/rows/row_source.h"

namespace pointsweep {

/// The way in which an output stores x, y and z, according to the options of its run.
struct StoredPlaces {
  std::optional<int> decimals = {};  ///< FileLayout::decimals, for text
  bool single = false;               ///< true if coordinates were rounded to float32 (RunOptions::positions)
};

/// Compares a value of one record with its copy in another, with the precision of the copy's type. Values are equal if
/// - both fields store values alike and the bits are equal; or
/// - the fields differ, or an option rounds coordinates (StoredPlaces), and storing the value of `from` in `to`, with
///   colours scaled to the brightness of the type, gives the value of `to`: a format may round (LAS coordinates), and a
///   value out of the range of its type equals no value. Integers on a decimal grid may be stored as the decimal
///   fractions that they stand for. If `from` is float32 and `to` float64, the float32 nearest to `to` is compared,
///   since text files hold the fewest digits that identify a float.
class FieldPair {
 public:
  /// Pairs one component of each field; `name` is used in messages. `places`: how the output stores coordinates;
  /// nothing for other values.
  FieldPair(std::string name, const Field& from, std::uint32_t from_component, const Field& to,
            std::uint32_t to_component, StoredPlaces places = {});

  /// Returns the pair for records of one file of the input and one file of the output, with the schemas `from` and
  /// `to`. Where files of a cloud store a field in different ways, for example LAS coordinates on different grids, its
  /// records have a float64 instead, and values are still compared as the two files store them. A null schema stands
  /// for the fields as the records have them.
  FieldPair in_files(const Schema* from, const Schema* to) const;

  const std::string& name() const { return name_; }
  bool is_coordinate() const { return is_coordinate_; }
  const std::string& name_in_output() const { return to_.name; }
  /// Returns a hash, equal for equal values: expected() for a record with `from`, found() for a record with `to`.
  std::uint64_t expected(const std::byte* from_record) const;
  std::uint64_t found(const std::byte* to_record) const;
  /// Returns how much `value` may change when a format stores it: half a unit in the last place of `to`, and a few
  /// roundings in float64; 0 if it is stored exactly.
  double resolution(double value) const;
  /// Returns by how much storing the value of `from` in the output changes it; 0 if no more than float64 rounds.
  double rounding(const std::byte* from_record) const;
  double expected_value(const std::byte* from_record) const { return value_of(from_, from_record); }
  double found_value(const std::byte* to_record) const { return value_of(to_, to_record); }
  /// Returns found_value(), rounded to float32 if the run has made or rounded it as float32 and `to` is float64, as in
  /// text with the fewest digits that identify a float32. With StoredPlaces::decimals it is not rounded.
  double found_number(const std::byte* to_record) const;

 private:
  void compare_as(const Field& from_file, const Field& to_file);
  double stored(double value) const;  ///< the value that a reader gets after `value` was stored in the output
  std::uint64_t word_of(double value) const;

  std::string name_;
  std::uint32_t from_component_, to_component_;
  Field from_, to_;
  Field from_file_, to_file_;  ///< the fields as the files store them
  StoredPlaces places_;
  bool is_coordinate_;
  bool bitwise_;
  GridDecimals decimals_;  ///< decimal fractions of integers on a decimal grid, as text files hold them
  bool single_;
};

/// The function Format::stored_name of a format; null for a format that changes no names.
using StoredName = std::string (*)(const std::string& name);

/// Pairs all components of from.fields[index] with the fields of `to` in which a writer of any format may have stored
/// them. Returns nothing if a component is missing. Writers change characters and lengths of names, number components,
/// use the spelling of their format, and add an exact copy NAME_TYPE of rounded values, which is then compared.
/// `places`: how the output stores x, y and z. `stored_name`: the names of the output's format.
std::optional<std::vector<FieldPair>> pairs_of_field(const Schema& from, std::size_t index, const Schema& to,
                                                     StoredPlaces places = {}, StoredName stored_name = nullptr);

/// The sum of the hashes of values modulo 2^64, which does not depend on their order. Equal multisets have equal sums;
/// different multisets have equal sums with a probability of about 2^-64.
class MultisetSum {
 public:
  void add(std::uint64_t value) { sum_ += mix(value); }
  std::uint64_t sum() const { return sum_; }

 private:
  std::uint64_t sum_ = 0;
};

/// Returns the number of the file that has row `row`.
std::size_t file_of_row(std::span<const FileOfRows> files, std::uint64_t row);

/// The pairs of fields for each row, as the file of the row stores the values (FieldPair::in_files). Only the pairs of
/// one file of each cloud are kept, so ascending rows are fastest.
class FilePairs {
 public:
  /// Borrows the sources. If they have equally many files, more than one, file i of the output is taken to hold rows of
  /// file i of the input. Otherwise, and with `in_any_order` (rows of the output may be in any file), values are
  /// compared as the records of the sources store them.
  FilePairs(const RowSource& in, const RowSource& out, bool in_any_order, std::vector<FieldPair> pairs);

  const std::vector<FieldPair>& all() const { return pairs_; }
  std::span<const FieldPair> of_input(std::uint64_t row) { return of(in_, row); }
  std::span<const FieldPair> of_output(std::uint64_t row) { return of(out_, row); }

 private:
  struct Side {
    std::span<const FileOfRows> files;
    std::uint64_t count;               ///< number of rows
    std::uint64_t first = 0, end = 0;  ///< rows of the file to which `pairs` belong
    std::vector<FieldPair> pairs = {};
  };
  std::span<const FieldPair> of(Side& side, std::uint64_t row);

  std::vector<FieldPair> pairs_;
  Side in_, out_;
  bool by_file_;
};

}  // namespace pointsweep
