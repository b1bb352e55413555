// SPDX-License-Identifier: MIT
#include "pointsweep/operators/expressions/expression.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "pointsweep/error.h"

namespace pointsweep {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Returns whether the condition holds for each value of `a`, with b = 10 and c = the 64-bit value at the same index.
std::vector<int> kept(const std::string& text, std::vector<double> a, std::vector<std::uint64_t> c = {},
                      bool is_signed = false) {
  const Expression expression(text);
  const std::vector<double> b(a.size(), 10);
  c.resize(a.size());
  std::vector<ExpressionValues> values;
  for (const Expression::Name& name : expression.names()) {
    if (name.text == "a") values.push_back({.real = a.data()});
    if (name.text == "b") values.push_back({.real = b.data()});
    if (name.text == "c") values.push_back({.whole = c.data(), .is_signed = is_signed});
  }
  std::vector<std::uint8_t> out(a.size(), 7);
  expression.evaluate(values, out);
  return {out.begin(), out.end()};
}

std::string refused(const std::string& text) {
  try {
    const Expression expression(text, "stage");
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

using Bits = std::vector<int>;

TEST(Expression, ComparesAsTheSignsSay) {
  EXPECT_EQ(kept("a == 2", {1, 2, 3}), (Bits{0, 1, 0}));
  EXPECT_EQ(kept("a != 2", {1, 2, 3}), (Bits{1, 0, 1}));
  EXPECT_EQ(kept("a < 2", {1, 2, 3}), (Bits{1, 0, 0}));
  EXPECT_EQ(kept("a <= 2", {1, 2, 3}), (Bits{1, 1, 0}));
  EXPECT_EQ(kept("a > 2", {1, 2, 3}), (Bits{0, 0, 1}));
  EXPECT_EQ(kept("2<=a", {1, 2, 3}), (Bits{0, 1, 1}));
}

TEST(Expression, AndBindsTighterThanOr) {
  EXPECT_EQ(kept("a == 1 || a == 2 && b == 9", {1, 2}), (Bits{1, 0}));
  EXPECT_EQ(kept("(a == 1 || a == 2) && b == 9", {1, 2}), (Bits{0, 0}));
  EXPECT_EQ(kept("!(a == 1) && !(a == 3)", {1, 2, 3}), (Bits{0, 1, 0}));
  EXPECT_EQ(kept("!!(a == 1)", {1, 2}), (Bits{1, 0}));
}

TEST(Expression, WordsBindAsTheirSigns) {
  EXPECT_EQ(kept("a == 1 or a == 2 and b == 9", {1, 2}), (Bits{1, 0}));
  EXPECT_EQ(kept("not a == 1 and a < 3", {1, 2, 3}), (Bits{0, 1, 0}));
  EXPECT_EQ(kept("not(a == 1)and not a == 3", {1, 2, 3}), (Bits{0, 1, 0}));
  EXPECT_EQ(kept("not !not a == 1", {1, 2}), (Bits{0, 1}));
  EXPECT_EQ(Expression("a<1 or not b<2 and c<3").canonical(), "a < 1 || !b < 2 && c < 3");
}

TEST(Expression, ListsHoldTheEqualNumbers) {
  EXPECT_EQ(kept("a in (2, 9)", {1, 2, 9}), (Bits{0, 1, 1}));
  EXPECT_EQ(kept("a not in (2, b - 1)", {1, 2, 9}), (Bits{1, 0, 0}));
  EXPECT_EQ(kept("not a + 1 in (3) or a == 1", {1, 2, 9}), (Bits{1, 0, 1}));
  EXPECT_EQ(kept("a in (2) and b in (10)", {1, 2, 9}), (Bits{0, 1, 0}));
  const std::vector<std::uint64_t> large = {9007199254740992, 9007199254740993};
  EXPECT_EQ(kept("c in (1, 9007199254740993)", {0, 0}, large), (Bits{0, 1}));
}

TEST(Expression, BetweenTakesBothBounds) {
  EXPECT_EQ(kept("a between 2 and 5", {1, 2, 5, 6}), (Bits{0, 1, 1, 0}));
  EXPECT_EQ(kept("a not between 2 and 5", {1, 2, 5, 6}), (Bits{1, 0, 0, 1}));
  EXPECT_EQ(kept("a between 2 and 5 and b == 10", {1, 2}), (Bits{0, 1}));
  EXPECT_EQ(kept("a between 1 + 1 and b / 2 && a != 3", {1, 2, 3, 5}), (Bits{0, 1, 0, 1}));
  EXPECT_EQ(kept("a between 5 and 2", {2, 3, 5}), (Bits{0, 0, 0}));
  EXPECT_EQ(kept("a BETWEEN 2 AND 5 AND NOT a == 3 OR a In (9)", {1, 2, 3, 9}), (Bits{0, 1, 0, 1}));
  EXPECT_EQ(Expression("a NOT IN (1) OR NOT b < 2 AND a > 1").canonical(), "a not in (1) || !b < 2 && a > 1");
}

TEST(Expression, FunctionsAreThoseOfTheirNames) {
  EXPECT_EQ(kept("abs(a) == 2", {-2, 2, 1}), (Bits{1, 1, 0}));
  EXPECT_EQ(kept("sqrt(a + 1) == 3", {8, 7}), (Bits{1, 0}));
  EXPECT_EQ(kept("min(a, 3, b) == 3 && max(a, 4) == 5", {5, 3}), (Bits{1, 0}));
  EXPECT_EQ(kept("floor(a) == -2 && ceil(a) == -1", {-1.5, -1}), (Bits{1, 0}));
  EXPECT_EQ(kept("round(a) == 2", {1.5, 2.5, 2.6}), (Bits{1, 1, 0}));
  EXPECT_EQ(kept("hypot(a, 4) == 5", {3, 4}), (Bits{1, 0}));
  EXPECT_EQ(kept("abs(log(a) - 1) < 1e-15 && abs(exp(1) - a) < 1e-15", {2.718281828459045, 2.7}), (Bits{1, 0}));
  EXPECT_EQ(kept("atan2(a, -1) > 0", {1, -1}), (Bits{1, 0}));
  EXPECT_EQ(kept("-abs (a) * 2 == -4", {-2, 4}), (Bits{1, 0}));
}

/// The words of the language are names where an operand stands, so that older expressions keep their meaning.
TEST(Expression, WordsAreNamesWhereAnOperandStands) {
  for (const char* text :
       {"in < 2 && and < 3", "between between or and not", "min in (in, max)", "not in in (1)", "not == 1", "2 < not"})
    EXPECT_FALSE(Expression(text).names().empty()) << text;
  EXPECT_EQ(Expression("between between or and not").names()[1].text, "or");
}

TEST(Expression, ArithmeticIsThatOfSchool) {
  EXPECT_EQ(kept("a + b * 2 - 1 == 20", {1, 2}), (Bits{1, 0}));
  EXPECT_EQ(kept("(a + b) * 2 == 22", {1, 2}), (Bits{1, 0}));
  EXPECT_EQ(kept("b - a - 1 == 7", {2, 4}), (Bits{1, 0}));
  EXPECT_EQ(kept("b / a / 5 == 1", {2, 4}), (Bits{1, 0}));
  EXPECT_EQ(kept("-a < -(-1) - 3", {1, 3}), (Bits{0, 1}));
  EXPECT_EQ(kept("a > 1e-3 && a < .5", {0.25, 1e-4}), (Bits{1, 0}));
}

TEST(Expression, FollowsIeeeWhereValuesAreMissing) {
  EXPECT_EQ(kept("a == a", {kNaN, 1}), (Bits{0, 1}));
  EXPECT_EQ(kept("a != 1", {kNaN, 1}), (Bits{1, 0}));
  EXPECT_EQ(kept("a < 1 || a >= 1", {kNaN, 1}), (Bits{0, 1}));
  EXPECT_EQ(kept("!(a < 1)", {kNaN, 0}), (Bits{1, 0}));
  EXPECT_EQ(kept("1 / a > 1e300", {0.0, 1}), (Bits{1, 0}));
  EXPECT_EQ(kept("a in (1, a)", {kNaN, 1}), (Bits{0, 1}));
  EXPECT_EQ(kept("a not in (1, a)", {kNaN, 1}), (Bits{1, 0}));
  EXPECT_EQ(kept("a between 0 and 2", {kNaN, 1}), (Bits{0, 1}));
  EXPECT_EQ(kept("a not between 0 and 2", {kNaN, 1}), (Bits{1, 0}));
  for (const char* number : {"sqrt(0 - 1)", "log(-1)", "min(1, a)", "min(a, 1)", "max(1, a)", "abs(a)", "exp(a)",
                             "round(a)", "hypot(a, 1)", "atan2(1, a)"})
    EXPECT_EQ(kept(fmt::format("{0} < 9 || {0} >= 9", number), {kNaN}), (Bits{0})) << number;
}

TEST(Expression, Compares64BitIntegersExactly) {
  const std::vector<std::uint64_t> large = {9007199254740992, 9007199254740993, ~std::uint64_t{0}};
  EXPECT_EQ(kept("c == 9007199254740993", {0, 0, 0}, large), (Bits{0, 1, 0}));
  EXPECT_EQ(kept("c < 9007199254740993", {0, 0, 0}, large), (Bits{1, 0, 0}));
  EXPECT_EQ(kept("c == 18446744073709551615", {0, 0, 0}, large), (Bits{0, 0, 1}));
  EXPECT_EQ(kept("c == 18446744073709551614", {0, 0, 0}, large), (Bits{0, 0, 0}));
  EXPECT_EQ(kept("c < 0", {0, 0, 0}, large, true), (Bits{0, 0, 1}));
  EXPECT_EQ(kept("c == -1", {0, 0, 0}, large, true), (Bits{0, 0, 1}));
  EXPECT_EQ(kept("c > -1", {0, 0, 0}, large), (Bits{1, 1, 1}));
  const std::vector<std::uint64_t> least = {std::uint64_t{1} << 63, (std::uint64_t{1} << 63) + 1};
  EXPECT_EQ(kept("c == -9223372036854775808", {0, 0}, least, true), (Bits{1, 0}));
  EXPECT_EQ(kept("c == -(-9223372036854775808)", {0, 0}, least), (Bits{1, 0}));
  EXPECT_EQ(kept("c > -9223372036854775808", {0, 0}, least, true), (Bits{0, 1}));
  EXPECT_EQ(kept("c > 1.5e19", {0, 0, 0}, large), (Bits{0, 0, 1}));
}

TEST(Expression, NamesAreListedOnceWithTheirPlace) {
  const Expression expression(" a.x_1 < b && b > a.x_1 ");
  ASSERT_EQ(expression.names().size(), 2u);
  EXPECT_EQ(expression.names()[0].text, "a.x_1");
  EXPECT_EQ(expression.names()[0].column, 1u);
  EXPECT_EQ(expression.names()[1].column, 9u);
  EXPECT_EQ(expression.text(), "a.x_1 < b && b > a.x_1");
}

TEST(Expression, BlanksMakeNoDifference) {
  EXPECT_EQ(Expression("a<-2&&!(b==3||c>= 1e3)||a+1*b-2/c!=0").canonical(),
            "a < -2 && !(b == 3 || c >= 1e3) || a + 1 * b - 2 / c != 0");
  EXPECT_EQ(Expression("a in(1,2)||b  not  in (3)&&min( a,b )between 1 and 2").canonical(),
            "a in (1, 2) || b not in (3) && min(a, b) between 1 and 2");
  EXPECT_EQ(Expression(Expression(" ! ( a <2 ) ").canonical()).canonical(), "!(a < 2)");
}

TEST(Expression, NamesBetweenBackquotesHaveAnyCharacter) {
  const Expression expression("not `a b`< 2 || `x && (y` in(`not`, a) && `a b` != `where`");
  std::vector<std::string> names;
  for (const Expression::Name& name : expression.names()) names.push_back(name.text);
  EXPECT_EQ(names, (std::vector<std::string>{"a b", "x && (y", "not", "a", "where"}));
  EXPECT_EQ(expression.names()[1].column, 17u);
  const std::string canonical = "!`a b` < 2 || `x && (y` in (`not`, a) && `a b` != `where`";
  EXPECT_EQ(expression.canonical(), canonical);
  EXPECT_EQ(Expression(canonical).canonical(), canonical);
  EXPECT_EQ(Expression("`nz`>0").canonical(), "nz > 0");
  EXPECT_EQ(kept("`a` == 2 && not `b` == 9", {1, 2, 3}), (Bits{0, 1, 0}));
  for (const char* name : {"nz", "`nz`", "`Pulse width`", "`not`"})
    EXPECT_TRUE(Expression(name, "", Expression::Form::number).is_name()) << name;
  EXPECT_FALSE(Expression("(`Pulse width`)", "", Expression::Form::number).is_name());
  EXPECT_EQ(refused("1 < `a b"), "stage: '1 < `a b', column 5: the ` that begins here has no second one.");
  EXPECT_EQ(refused("1 < ``"), "stage: '1 < ``', column 5: a name is expected between two `.");
  EXPECT_EQ(with_hidden_names("a `b, c` = `d` `e"), "a `````` = ``` `e");
}

TEST(Expression, TellsTheColumnOfAMistake) {
  EXPECT_EQ(refused("a < 2 && z = 3"), "stage: 'a < 2 && z = 3', column 12: '=' compares nothing; write ==.");
  EXPECT_EQ(refused("a <"), "stage: 'a <', column 4: an attribute or a number is expected, but the expression ends.");
  EXPECT_EQ(refused("a < 2)"), "stage: 'a < 2)', column 6: an operator such as && or the end is expected, not ')'.");
  EXPECT_EQ(refused("(a < 2"), "stage: '(a < 2', column 7: ')' is expected, but the expression ends.");
  EXPECT_EQ(refused("a && b < 1"), "stage: 'a && b < 1', column 1: a comparison is expected, such as z < 100.");
  EXPECT_EQ(refused("a < 1 || b"), "stage: 'a < 1 || b', column 10: a comparison is expected, such as z < 100.");
  EXPECT_EQ(refused("(a < 1) + 2 > 3"),
            "stage: '(a < 1) + 2 > 3', column 1: an attribute or a number is expected, not a comparison.");
  EXPECT_EQ(refused("a < b < c"),
            "stage: 'a < b < c', column 7: an operator such as && or the end is expected, not '<'.");
  EXPECT_EQ(refused("a < 2x"), "stage: 'a < 2x', column 5: an attribute or a number is expected, not '2'.");
  EXPECT_EQ(refused("a in ()"), "stage: 'a in ()', column 7: an attribute or a number is expected, not ')'.");
  EXPECT_EQ(refused("5 in"),
            "stage: '5 in', column 5: a list of numbers such as (2, 9) is expected, but the expression ends.");
  EXPECT_EQ(refused("a in 2"), "stage: 'a in 2', column 6: a list of numbers such as (2, 9) is expected, not '2'.");
  EXPECT_EQ(refused("a in (2 9)"), "stage: 'a in (2 9)', column 9: ',' or ')' is expected, not '9'.");
  EXPECT_EQ(refused("a between 2"),
            "stage: 'a between 2', column 12: 'and' with the upper bound, as in between 2 and 5, is expected, but the "
            "expression ends.");
  EXPECT_EQ(refused("a not 2"), "stage: 'a not 2', column 3: 'in' or 'between' is expected after 'not'.");
  EXPECT_EQ(refused("sin(a) > 1"),
            "stage: 'sin(a) > 1', column 1: there is no function 'sin'; there are abs sqrt min max floor ceil round "
            "hypot log exp atan2.");
  EXPECT_EQ(refused("hypot(a) > 1"), "stage: 'hypot(a) > 1', column 1: hypot takes 2 numbers, not 1.");
  EXPECT_EQ(refused("min(a) > 1"), "stage: 'min(a) > 1', column 1: min takes 2 or more numbers, not 1.");
  EXPECT_EQ(refused("abs(a, 2) > 1"), "stage: 'abs(a, 2) > 1', column 1: abs takes 1 number, not 2.");
  EXPECT_NE(refused("abs(a < 2) > 1").find("column 7"), std::string::npos);
  EXPECT_NE(refused("a & b").find("column 3"), std::string::npos);
  EXPECT_NE(refused("  ").find("the condition is empty"), std::string::npos);
  EXPECT_NE(refused(std::string(5000, '(') + "a < 1" + std::string(5000, ')')).find("more than 100"),
            std::string::npos);
  EXPECT_NE(refused(std::string(5000, '!') + "(a < 1)").find("more than 100"), std::string::npos);
  EXPECT_NE(refused(std::string(5000, '-') + "a < 1").find("more than 100"), std::string::npos);
}

}  // namespace
}  // namespace pointsweep
