// SPDX-License-Identifier: MIT
/// Expressions that users write (docs/adr/0009): conditions on attributes, such as classification == 2 && z < 100, and
/// numbers that are computed from attributes, such as intensity * 2.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pointsweep {

/// The values of one attribute for a batch of points: as 64-bit integers if `whole` is not null, else as float64, which
/// holds every type up to 53 bits exactly.
struct ExpressionValues {
  const double* real = nullptr;
  const std::uint64_t* whole = nullptr;  ///< two's complement if `is_signed`
  bool is_signed = false;
};

/// A type that holds every 64-bit integer, signed or unsigned.
__extension__ typedef __int128 WholeNumber;

/// Returns whether a name without backquotes may continue with the character: a letter, a digit, _ or `.`.
bool continues_name(char c);
/// Returns the name of an attribute as expressions spell it: between backquotes if it is no plain name.
std::string spelled_name(std::string_view name);
/// Returns the name that stands alone in `text`, without backquotes around it; an empty text if there is none.
std::string_view name_in(std::string_view text);
/// Returns the text with a backquote in place of each character between backquotes, where no sign or word has a
/// meaning.
std::string with_hidden_names(std::string_view text);
/// Returns the text without blanks and ends of lines at both ends.
std::string_view without_outer_blanks(std::string_view text);

/// A condition, or a number. The grammar begins with the operators that bind most loosely; blanks matter only between
/// words:
///   condition = both {("||" | "or") both}      both = test {("&&" | "and") test}
///   test = ("!" | "not") test | "(" condition ")" | sum ("==" | "!=" | "<" | "<=" | ">" | ">=") sum |
///          sum ["not"] "in" "(" sum {"," sum} ")" | sum ["not"] "between" sum "and" sum
///   sum = product {("+" | "-") product}        product = factor {("*" | "/") factor}
///   factor = "-" factor | number | name | function "(" sum {"," sum} ")" | "(" sum ")"
///   name = letter or _ {letter, digit, _ or .} | "`" any text without "`" "`"
/// A word in the place of an operand is a name. The word `not` is a name only before a sign that cannot follow the
/// operator `not`, as in not == 1. Numbers are float64 and follow IEEE 754: a comparison with NaN is false, except that
/// != is true, and x / 0 is infinite or NaN. A comparison of a 64-bit integer attribute with a second attribute of this
/// kind or with a whole number is exact; all other operations are in float64, and round 64-bit integers to float64.
/// `in` compares like ==, and `between` like >= and <=.
class Expression {
 public:
  enum class Form : std::uint8_t { condition, number /**< a sum of the grammar */ };
  /// Throws UsageError for an invalid text. The message begins with `where`, and states the column, from 1 on, and what
  /// is expected there.
  explicit Expression(std::string_view text, std::string_view where = "where", Form form = Form::condition);

  struct Name {
    std::string text;
    std::size_t column;  ///< column of its first occurrence, from 1 on
  };
  /// Returns the names of the attributes that the expression reads, each once, in the order of their first occurrence.
  const std::vector<Name>& names() const { return names_; }
  /// Returns whether the expression is a single name and nothing else.
  bool is_name() const;
  const std::string& text() const { return text_; }  ///< the text as given, without blanks at both ends
  /// Returns a text that is equal for expressions that differ only in blanks, in the case of the words of the grammar,
  /// and in "and", "or", "not" for "&&", "||", "!": "a < 2 && !(b == 3)".
  const std::string& canonical() const { return canonical_; }

  /// Sets kept[i] to 1 where the condition holds for point i, else to 0. `values` has the order of names().
  void evaluate(std::span<const ExpressionValues> values, std::span<std::uint8_t> kept) const;

  /// Evaluates an expression that gives a number: sets values_of_points[i] to its value for point i.
  void evaluate_number(std::span<const ExpressionValues> values, std::span<double> values_of_points) const;
  /// Returns whether the expression is a single name whose values are 64-bit integers, or a single whole number. Only
  /// then may evaluate_whole() be called. It returns exact values.
  bool is_whole(std::span<const ExpressionValues> values) const;
  void evaluate_whole(std::span<const ExpressionValues> values, std::span<WholeNumber> values_of_points) const;

  struct Node;

 private:
  std::string text_, canonical_;
  std::vector<Name> names_;
  std::shared_ptr<const Node> root_;
};

/// A function that expressions call by name.
struct ExpressionFunction {
  std::string_view name;
  std::size_t least, most;  ///< least and largest number of arguments
  double (*value)(std::span<const double> arguments);
};

/// Returns the function with a name; null if no function has it.
const ExpressionFunction* expression_function(std::string_view name);

/// Returns the names of all functions, separated by blanks.
std::string names_of_functions();

/// The operation of a node. Operations from `equal` on give a truth value, the others a number.
enum class Operation : std::uint8_t {
  number,
  name,
  negate,
  add,
  subtract,
  multiply,
  divide,
  function,
  equal,
  unequal,
  less,
  less_equal,
  greater,
  greater_equal,
  among,    ///< true if the first part is equal to one of the others
  between,  ///< true if the first part is between the second and the third, inclusive
  no,
  both,
  either
};

struct Expression::Node {
  Operation operation = Operation::number;
  double number = 0;
  std::optional<WholeNumber> whole = {};  ///< exact value of a literal without `.` and exponent that fits in 64 bits
  std::size_t name = 0;                   ///< index in Expression::names()
  const ExpressionFunction* function = nullptr;
  std::vector<Node> parts = {};

  bool is_condition() const { return operation >= Operation::equal; }
};

}  // namespace pointsweep
