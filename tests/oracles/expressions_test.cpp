// SPDX-License-Identifier: MIT
/// Compares the values of random expressions, which the test computes while it makes their text, with the values of the
/// tool and of verify. verify parses expressions by separate code.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/math/exp.h"
#include "pointsweep/operators/expressions/expression.h"
#include "pointsweep/verify/formulas/plain_expression.h"

namespace pointsweep {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Value {
  double real = 0;
  std::optional<WholeNumber> whole = {};
  bool is_literal = false;
};

/// A piece of text, its value, and how tightly its outermost operator binds; truth values are 0 and 1.
struct Piece {
  std::string text;
  Value value;
  int rank = 0;
};
enum Rank { kOr, kAnd, kNot, kComparison, kSum, kProduct, kSign, kOperand };

struct Names {
  double a = 0, b = 0;
  std::int64_t c = 0;
};

class ExpressionMaker {
 public:
  ExpressionMaker(std::uint64_t seed, Names names) : random_(seed), names_(names) {}

  Piece condition(int depth) {
    const auto truth = [](const Piece& p) { return p.value.real != 0; };
    const auto made = [](std::string text, bool holds, int rank) {
      return Piece{std::move(text), {.real = holds ? 1.0 : 0.0}, rank};
    };
    const unsigned kind = depth == 0 ? 4 : pick(7);
    if (kind < 2) {
      const bool is_or = kind == 0;
      const Piece left = condition(depth - 1), right = condition(depth - 1);
      const int rank = is_or ? kOr : kAnd;
      const std::string sign = is_or ? one_of({" || ", " or ", "||"}) : one_of({" && ", " and ", "&&"});
      const bool holds = is_or ? truth(left) || truth(right) : truth(left) && truth(right);
      return made(in(left, rank) + sign + in(right, rank + 1), holds, rank);
    }
    if (kind == 2) {
      const Piece part = condition(depth - 1);
      return made(one_of({"!", "not "}) + in(part, kNot), !truth(part), kNot);
    }
    const Piece left = number(depth);
    const std::string at = in(left, kSum);
    if (kind == 3 || kind == 5) {
      const bool is_negated = pick(2) == 0;
      bool found = false;
      std::string text = at + (is_negated ? " not" : "");
      if (kind == 3) {
        text += one_of({" in (", " in("});
        for (unsigned i = 0, count = 1 + pick(3); i < count; ++i) {
          const Piece member = number(depth - 1);
          text += (i == 0 ? "" : ", ") + in(member, kSum);
          found = found || compared("==", left.value, member.value);
        }
        return made(text + ")", found != is_negated, kComparison);
      }
      const Piece low = number(depth - 1), high = number(depth - 1);
      found = compared(">=", left.value, low.value) && compared("<=", left.value, high.value);
      text += " between " + in(low, kSum) + " and " + in(high, kSum);
      return made(text, found != is_negated, kComparison);
    }
    const std::string sign = one_of({"==", "!=", "<", "<=", ">", ">="});
    const Piece right = number(depth);
    return made(at + blank() + sign + blank() + in(right, kSum), compared(sign, left.value, right.value), kComparison);
  }

  Piece number(int depth) {
    switch (depth <= 0 ? pick(4) : pick(8)) {
      case 0:
        return literal();
      case 1:
        return {one_of({"a", "`a`"}), {.real = names_.a}, kOperand};
      case 2:
        return {"b", {.real = names_.b}, kOperand};
      case 3:
        return {"c", {.real = static_cast<double>(names_.c), .whole = names_.c}, kOperand};
      case 4: {
        const Piece part = number(depth - 1);
        Value value{.real = -part.value.real, .is_literal = part.value.is_literal};
        if (part.value.is_literal && part.value.whole && *part.value.whole <= WholeNumber{1} << 63)
          value.whole = -*part.value.whole;
        return {"-" + in(part, kSign), value, kSign};
      }
      case 5: {
        const std::string name =
            one_of({"abs", "sqrt", "min", "max", "floor", "ceil", "round", "hypot", "exp", "log", "atan2"});
        const ExpressionFunction& function = *expression_function(name);
        std::vector<double> arguments;
        std::string text = name + one_of({"(", " ("});
        for (std::size_t i = 0; i < function.least; ++i) {
          const Piece argument = number(depth - 1);
          arguments.push_back(argument.value.real);
          text += (i == 0 ? "" : ",") + in(argument, kSum);
        }
        return {text + ")", {.real = defined(name, arguments)}, kOperand};
      }
      default: {
        const unsigned sign = pick(4);
        const Piece left = number(depth - 1), right = number(depth - 1);
        const int rank = sign < 2 ? kSum : kProduct;
        const double x = left.value.real, y = right.value.real;
        return {in(left, rank) + blank() + "+-*/"[sign] + blank() + in(right, rank + 1),
                {.real = sign == 0   ? x + y
                         : sign == 1 ? x - y
                         : sign == 2 ? x * y
                                     : x / y},
                rank};
      }
    }
  }

 private:
  Piece literal() {
    static constexpr std::pair<const char*, double> kReals[] = {{"0.5", 0.5}, {"2e0", 2}, {".25", 0.25}};
    static constexpr std::uint64_t kWholes[] = {
        0, 1, 2, 9, 9007199254740993, std::uint64_t{1} << 63, (std::uint64_t{1} << 63) - 1};
    if (pick(3) == 0) {
      const auto& [text, real] = kReals[pick(3)];
      return {text, {.real = real, .is_literal = true}, kOperand};
    }
    const std::uint64_t whole = kWholes[pick(7)];
    return {fmt::format("{}", whole),
            {.real = static_cast<double>(whole), .whole = WholeNumber{whole}, .is_literal = true},
            kOperand};
  }

  /// Returns the text of a piece as an operand whose operators must bind at least as tightly as `rank`, in parentheses
  /// if needed.
  std::string in(const Piece& piece, int rank) {
    return piece.rank < rank || pick(8) == 0 ? "(" + piece.text + ")" : piece.text;
  }

  /// Returns the value of a function by its definition. exp, log and atan2 are taken from the library, since no
  /// definition gives their rounding; tests/math has their oracle.
  static double defined(const std::string& name, const std::vector<double>& v) {
    const double x = v[0], y = v.size() > 1 ? v[1] : 0;
    const bool is_nan = std::isnan(x) || std::isnan(y);
    if (name == "abs") return std::signbit(x) ? -x : x;
    if (name == "sqrt") return std::sqrt(x);
    if (name == "min") return is_nan ? kNaN : y < x ? y : x;
    if (name == "max") return is_nan ? kNaN : y > x ? y : x;
    if (name == "hypot") return std::sqrt(x * x + y * y);
    if (name == "exp") return exponential(x);
    if (name == "log") return logarithm(x);
    if (name == "atan2") return arctangent2(x, y);
    if (!(std::fabs(x) < 0x1p52) || x == 0) return x;  // whole numbers, infinite ones and NaN
    double below = static_cast<double>(static_cast<std::int64_t>(x));
    if (below > x) below -= 1;
    const double rest = x - below;
    const bool is_odd = std::fmod(below, 2) != 0;
    const bool up = name == "ceil" ? rest > 0 : name == "round" && (rest > 0.5 || (rest == 0.5 && is_odd));
    return std::copysign(up ? below + 1 : below, x);
  }

  static bool compared(const std::string& sign, const Value& a, const Value& b) {
    const auto holds = [&](auto x, auto y) {
      return sign == "=="   ? x == y
             : sign == "!=" ? x != y
             : sign == "<"  ? x < y
             : sign == "<=" ? x <= y
             : sign == ">"  ? x > y
                            : x >= y;
    };
    const bool is_exact = a.whole && b.whole && !(a.is_literal && b.is_literal);
    return is_exact ? holds(*a.whole, *b.whole) : holds(a.real, b.real);
  }

  unsigned pick(unsigned count) { return static_cast<unsigned>(random_() % count); }
  std::string one_of(std::vector<std::string> words) { return words[pick(static_cast<unsigned>(words.size()))]; }
  std::string blank() { return one_of({"", " "}); }

  std::mt19937_64 random_;
  Names names_;
};

constexpr Names kCases[] = {{1, 2, 9},
                            {-0.5, 2.5, 9007199254740993},
                            {kNaN, 0, std::numeric_limits<std::int64_t>::min()},
                            {0, kNaN, std::numeric_limits<std::int64_t>::max()},
                            {1e300, std::numeric_limits<double>::infinity(), -1}};

TEST(Expressions, ToolAndVerifyFindWhatTheTextMeans) {
  int undecided = 0, all = 0, held = 0;
  for (std::uint64_t seed = 0; seed < 20'000; ++seed) {
    const Names& names = kCases[seed % std::size(kCases)];
    const Piece piece = ExpressionMaker(seed, names).condition(3);
    const bool truth = piece.value.real != 0;

    const Expression expression(piece.text);
    const auto c = static_cast<std::uint64_t>(names.c);
    std::vector<ExpressionValues> values;
    for (const Expression::Name& name : expression.names())
      values.push_back(name.text == "c" ? ExpressionValues{.whole = &c, .is_signed = true}
                                        : ExpressionValues{.real = name.text == "a" ? &names.a : &names.b});
    std::uint8_t kept = 7;
    expression.evaluate(values, {&kept, 1});
    ASSERT_EQ(kept, truth) << piece.text << " of case " << seed % std::size(kCases);
    ASSERT_EQ(Expression(expression.canonical()).canonical(), expression.canonical()) << piece.text;

    for (const std::string& text : {piece.text, expression.canonical()}) {
      const formulas::PlainExpression plain(text);
      std::vector<formulas::PossibleNumber> ranges;
      for (const std::string& name : plain.names()) {
        const formulas::Real v = name == "a" ? names.a : name == "b" ? names.b : static_cast<formulas::Real>(names.c);
        ranges.push_back({v, v, name == "c"});
      }
      const std::optional<bool> found = plain.holds(ranges);
      ++all, undecided += !found, held += truth;
      ASSERT_EQ(found.value_or(truth), truth) << text << " of case " << seed % std::size(kCases);

      for (formulas::PossibleNumber& range : ranges)
        if (std::isfinite(range.low)) range.low -= 0.25, range.high += 0.5;
      ASSERT_EQ(plain.holds(ranges).value_or(truth), truth) << text;
    }
  }
  EXPECT_LT(undecided, all / 20);
  EXPECT_GT(held, all / 4);
  EXPECT_LT(held, all * 3 / 4);
}

}  // namespace
}  // namespace pointsweep
