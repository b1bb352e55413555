// SPDX-License-Identifier: MIT
/// The values that names mean: a name that a user writes for a single value, in conditions, assignments and options
/// that name an attribute, and the exact name of an attribute that an operator reads. Assignments also need the values
/// that an attribute can hold, and expressions the values of a batch of points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/operator.h"
#include "pointsweep/operators/expressions/expression.h"

namespace pointsweep {

/// A component of a made attribute, or a field of the input, that a name means. Both pointers are null if the name
/// means nothing.
struct MeantValue {
  const Attribute* made = nullptr;
  std::size_t component = 0;     ///< component of `made`
  const Field* field = nullptr;  ///< field of the input; null if `made` is not null
};

/// Returns the value that `word` names, in any spelling that files use. A made attribute precedes a field of the input,
/// with one exception: `word` is the exact name of a field of the input, and for made attributes a spelling of several
/// names, as "curvature" is. Moved positions are never returned: x, y and z mean the fields of the input.
MeantValue meant_value(const std::string& word, const Schema& input, std::span<const Attribute> made);

/// Returns the value that `word` names in an expression: meant_value(). If that finds nothing for "row", returns the
/// number of the row in the inputs (input_row.h).
MeantValue value_in_expression(const std::string& word, const Schema& input, std::span<const Attribute> made);

/// Returns the expression of the attribute that an option names. `name` needs no backquotes if a value has this name.
/// Throws UsageError for a text that is neither such a name nor an expression.
Expression expression_of_attribute(const std::string& name, const std::string& place, const Schema& input,
                                   std::span<const Attribute> made);

/// Returns the number of the axis whose coordinate `name` means in any spelling: 0, 1 or 2; nullopt if it means none.
std::optional<std::size_t> axis_of(std::string_view name);

/// Returns whether one of the attributes `made` has this name.
bool makes(std::span<const Attribute> made, std::string_view name);

/// Returns the type of a field of the input; for packed bits the smallest type that holds them, for scaled numbers
/// float64.
Type type_of_values(const Field& field);

/// Returns the attribute `name` if an earlier stage makes it and it has one value, else the field `name` of the input
/// as float64 if that is no array; nullopt if there is neither.
std::optional<Attribute> single_value(const char* name, const Schema& input, std::span<const Attribute> made);

/// The values that an attribute can hold.
struct TargetRange {
  Type type = Type::f64;
  double least = 0, most = 0;  ///< range of whole numbers
  bool is_whole = false;

  /// Returns the range as text: "uint8, 0 to 255" or "float32".
  std::string text() const;
};

TargetRange range_of(Type type);
/// Returns the range of a field of the input; for packed bits, the range of the bits.
TargetRange range_of(const Field& field);

/// Returns a whole number as a T, the integer type of the range; nullopt for a number outside of the range.
template <class T>
std::optional<T> whole_in(const TargetRange& range, double whole) {
  // float64 does not hold the largest 64-bit integer; the nearest float64 is too large.
  const bool below = range.most < 0x1p53 ? whole <= range.most : whole < range.most;
  if (!(whole >= range.least && below)) return std::nullopt;
  return static_cast<T>(whole);
}
template <class T>
std::optional<T> whole_in(const TargetRange& range, WholeNumber whole) {
  const auto number = static_cast<T>(whole);
  const bool fits = WholeNumber{number} == whole && (range.most >= 0x1p53 || static_cast<double>(number) <= range.most);
  return fits ? std::optional(number) : std::nullopt;
}

/// An existing attribute as the target of an assignment.
struct AssignedTarget {
  Attribute made;             ///< new version of an attribute that was made before, or of a field of the input
  std::size_t component = 0;  ///< component that the name means
  TargetRange range;
  Attribute old;  ///< the previous version in a type that can be read exactly
};

/// Returns the target that `name` means: an attribute that was made before, or a field of the input; nullopt if there
/// is none. `name` must not be a coordinate. Throws UsageError, beginning with `place`, if `name` means several values.
std::optional<AssignedTarget> target_of(const std::string& name, const Schema& input, std::span<const Attribute> made,
                                        const std::string& place);

/// The meanings of the names of an expression. A name means, in this order: a component of an attribute that was made
/// before ("nz", "outlier"); x, y or z, the current position; a field of the input, in any spelling that files use
/// (meant_value()), but no array; `row`, the number of the row in the inputs.
class NamedValues {
 public:
  NamedValues() = default;
  /// Messages begin with `place`. Throws UsageError for a name of several values, and for an unknown name, with the
  /// known names.
  NamedValues(const Expression& expression, const std::string& place, const Schema& input,
              std::span<const Attribute> made);

  /// Returns the attributes that must be read, each once.
  const std::vector<Attribute>& reads() const { return reads_; }

  /// The values of one batch, in the order of the names.
  class Batch {
   public:
    /// Reads the values of the points of the batch. `first`: index of the first attribute of reads() in the
    /// contract().reads of the operator.
    Batch(const NamedValues& names, const Neighborhoods& in, std::size_t first = 0);
    /// Reads the values of some neighbours of the batch. `first`: index of the first attribute of reads() in the
    /// contract().reads_neighbors of the operator.
    Batch(const NamedValues& names, const Neighborhoods& in, std::size_t first, std::span<const NeighborRef> neighbors);
    std::span<const ExpressionValues> values() const { return values_; }

   private:
    /// Reads the values of `count` points. `position(i)` returns the position of point i, `record(a, i, bytes)` the
    /// address of its value of reads()[a], which has `bytes` bytes.
    template <class Position, class Record>
    void take(const NamedValues& names, std::size_t count, Position position, Record record);

    /// The memory of the values of one name, to which the pointers in values_ point.
    struct Memory {
      std::vector<double> real;
      std::vector<std::uint64_t> whole;
    };
    std::vector<Memory> memory_;
    std::vector<ExpressionValues> values_;
  };

  /// The source of the values of a name: component `component` of reads()[attribute], or of the position of the point
  /// if `attribute` is negative.
  struct Source {
    int attribute = -1;
    std::size_t component = 0;
  };
  const std::vector<Source>& sources() const { return sources_; }

 private:
  Source read(Attribute attribute, std::size_t component);

  std::vector<Attribute> reads_;
  std::vector<Source> sources_;  ///< in the order of Expression::names()
};

}  // namespace pointsweep
