// SPDX-License-Identifier: MIT
/// Declarations of operators, and of the stage `knn`. Pipelines as text and JSON, flags of verbs, help, docs,
/// checkpoints and the records in outputs all use these declarations, and so may programs that show operators and
/// options to people.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/export.h"
#include "pointsweep/geometry.h"
#include "pointsweep/neighborhood.h"
#include "pointsweep/operator.h"
#include "pointsweep/option.h"

namespace pointsweep {

enum class OptionKind : std::uint8_t {
  whole,        ///< std::uint64_t from `least` to `most`
  number,       ///< finite double from `least` to `most`
  choice,       ///< std::string, one of `choices`
  names,        ///< std::string, some of `choices`, each once, with commas between
  point,        ///< Vec3, finite
  attribute,    ///< std::string, the name of an attribute; not empty
  condition,    ///< std::string, a condition on attributes; not empty
  numbers,      ///< std::string, finite numbers with commas between, each in its shortest form
  file,         ///< std::string, the name of a file or its content; not empty
  matrix,       ///< std::string, a matrix row by row, or the name of a file that holds it; not empty
  word,         ///< std::string, letters and digits; not empty
  attributes,   ///< std::string, names of attributes with commas between; none empty
  assignments,  ///< std::string, NAME = EXPRESSION or NAME = EXPRESSION where CONDITION, with commas between; not empty
};

/// The least number above 0, as the limit of options that must be positive.
inline constexpr double kAboveZero = std::numeric_limits<double>::denorm_min();

struct POINTSWEEP_EXPORT OptionDeclaration {
  std::string name = {};
  OptionKind kind = OptionKind::word;
  OptionValue preset = {};   ///< value of an option that is not given; std::monostate if it has no such value
  std::string meaning = {};  ///< one line that begins in lower case
  double least = 0;
  double most = std::numeric_limits<double>::infinity();
  /// Unit of a number, e.g. "length"; empty if the number has none. The preset of a length is in metres. It is
  /// converted for clouds whose unit is known to be another unit.
  std::string unit = {};
  std::vector<std::string> choices = {};
  bool required = false;    ///< true if a value must be given
  bool positional = false;  ///< true if pipelines omit its name, as in where("z < 2"); only for a first option
  OptionValue sample = {};  ///< value in examples of an option without a preset
  /// True for a distance R within which points count, or for an attribute that holds R. All operators test d² <= R·R in
  /// double.
  bool is_radius = false;

  /// Returns the allowed values: "1 or more", "0 to 90", "none, up or input", "[X,Y,Z]".
  std::string allowed() const;
  /// Returns whether `value` has the type of the kind and lies within the limits.
  bool allows(const OptionValue& value) const;
  /// Throws UsageError that names `where`, the allowed values and `value`.
  [[noreturn]] void refuse(const std::string& value, const std::string& where) const;
};

/// Returns a value as text: numbers in their shortest form, points as "0,0,1.7", std::monostate as "". parse_value()
/// restores the value.
POINTSWEEP_EXPORT std::string text_of_value(const OptionValue& value);

/// The values of an operator's options: the given values, else the presets.
class POINTSWEEP_EXPORT OptionValues {
 public:
  /// Makes an object that holds only presets. `where` begins every message about the options, e.g. "pipeline, column
  /// 12: normals".
  OptionValues(const std::vector<OptionDeclaration>& declared, std::string where);

  /// Stores a value. Returns false if the option has been given before. `name` must be declared, and its declaration
  /// must allow `value`.
  bool give(const std::string& name, OptionValue value);
  /// Returns the given values, with the presets of `declared` for options that are not given.
  OptionValues with_presets_of(const std::vector<OptionDeclaration>& declared) const;

  bool given(std::string_view name) const { return given_.contains(name); }
  /// Returns the given value, else the preset; null if there is neither.
  const OptionValue* find(std::string_view name) const;
  bool any_given() const { return !given_.empty(); }
  /// Returns the value of a declared option by its name. An option without a preset must be given or required.
  std::uint64_t whole(std::string_view name) const { return std::get<std::uint64_t>(value(name)); }
  double number(std::string_view name) const { return std::get<double>(value(name)); }
  /// Returns the value of a choice, of names, of an attribute or of a condition.
  const std::string& word(std::string_view name) const { return std::get<std::string>(value(name)); }

  const std::string& where() const { return where_; }

 private:
  const OptionValue& value(std::string_view name) const { return *find(name); }

  std::string where_;
  std::map<std::string, OptionValue, std::less<>> given_, preset_;
};

/// Facts about the cloud and the neighbourhoods that an operator may need when it is made.
struct Facts {
  std::uint64_t points = 0;
  std::optional<Neighborhood> neighborhood = {};  ///< neighbourhood of the operator; absent: unknown
  double metres_per_unit = 1;                     ///< metres in a unit of the coordinates
};

/// A description of an attribute for docs/attributes.md, if Attribute::meaning is too short.
struct AttributeNote {
  std::string name;
  std::string meaning;
  std::string type = {};   ///< stated if the attribute can have several types
  std::string shape = {};  ///< stated if the shape is not known in advance, e.g. "N×k"
};

struct OperatorDeclaration {
  std::string name;
  std::string meaning;  ///< one line that begins in lower case
  std::vector<OptionDeclaration> options = {};
  /// Makes the stage `name`. Throws UsageError, beginning with OptionValues::where(), for values in conflict.
  std::function<ChainStage(const OptionValues&, const Facts&)> make;
  std::string formula = {};    ///< lines of plain text
  std::string source = {};     ///< the publication and the place in it
  std::string undefined = {};  ///< the points without a result, and the value that they get
  /// A clause about the points that the operator marks as degenerate (Columns::mark_degenerate), e.g. "have no
  /// neighbours; their density is 0"; empty if it marks no points.
  std::string degenerate = {};
  std::string cost = {};     ///< costs other than the time `neighbor_ns`
  double neighbor_ns = 10;   ///< CPU time in ns for each of about 1,000 neighbours, by `script/bench radius`
  bool makes_named = false;  ///< true if the options name the attributes that the operator makes
  std::vector<AttributeNote> attributes = {};  ///< notes on the attributes that the operator makes
  std::string example = {};                    ///< a complete pipeline
};

/// Splits "a,b" into {"a", "b"}: the words of an option of the kind `names`. A word between backquotes may have commas.
POINTSWEEP_EXPORT std::vector<std::string> words_of(std::string_view list);
/// Joins words to a list that words_of() splits: "a,b". Words with a comma get backquotes.
POINTSWEEP_EXPORT std::string list_of_words(const std::vector<std::string>& words);
/// Parses "1,2.5" to {1, 2.5}: an option of the kind `numbers`. Returns an empty list if a word is no finite number.
POINTSWEEP_EXPORT std::vector<double> numbers_of(std::string_view list);
/// Returns {1, 2.5} as "1,2.5": each number in its shortest form, so that equal lists have equal texts.
POINTSWEEP_EXPORT std::string text_of_numbers(const std::vector<double>& numbers);

/// The declaration of the stage `knn` of a pipeline, which is no operator: it defines the neighbourhoods of all stages.
struct NeighborhoodDeclaration {
  std::string name;
  std::string meaning;
  std::vector<OptionDeclaration> options;
  std::string formula, source, cost;
  std::string example;  ///< a complete pipeline
};

POINTSWEEP_EXPORT const NeighborhoodDeclaration& neighborhood_declaration();

/// Returns the neighbourhood that options of `knn` define. Throws UsageError, beginning with OptionValues::where(), for
/// values in conflict.
POINTSWEEP_EXPORT Neighborhood make_neighborhood(const OptionValues& options);

/// Returns example values for docs and checks of a declaration: presets, and samples of required and of positional
/// options.
POINTSWEEP_EXPORT OptionValues sample_values(const OperatorDeclaration& declaration);
/// Returns the contract of the operator with sample_values(), without attributes that are never written, and without
/// made attributes if the options name them.
POINTSWEEP_EXPORT Contract contract_of(const OperatorDeclaration& declaration);

}  // namespace pointsweep
