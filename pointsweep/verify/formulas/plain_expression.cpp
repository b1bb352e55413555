// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/plain_expression.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

namespace pointsweep::formulas {
namespace {

constexpr PossibleNumber kAnything{-kInfinity, kInfinity, false};

double plain(char sign, double a, double b) {
  return sign == '+' ? a + b : sign == '-' ? a - b : sign == '*' ? a * b : a / b;
}

/// Returns the range in which the tool's float64 result lies if `value` is the exact result.
PossibleNumber near(Real value) {
  if (!std::isfinite(value)) return single_number(value);
  const Real slack = 16 * kDouble * std::fabs(value) + 0x1p-1074L;
  constexpr Real kMost = std::numeric_limits<double>::max();
  if (value - slack > kMost) return single_number(kInfinity);
  return {value - slack, value + slack > kMost ? kInfinity : value + slack, false};
}

/// Returns the range of the values of an increasing function on the range `n`.
template <class Function>
PossibleNumber increasing(const PossibleNumber& n, Function function) {
  return {function(static_cast<double>(n.low)), function(static_cast<double>(n.high)), false};
}

PossibleNumber absolute(const PossibleNumber& n) {
  const Real low = std::fabs(n.low), high = std::fabs(n.high);
  if (n.is_exact()) return single_number(low);
  return {n.low <= 0 && n.high >= 0 ? 0 : std::min(low, high), std::max(low, high), false};
}

PossibleNumber root(const PossibleNumber& n) {
  if (!n.is_exact() && n.low < 0) return kAnything;
  return increasing(n, [](double v) { return std::sqrt(v); });
}

/// Returns the range of the greatest of the numbers if `sign` is 1, of the least if `sign` is -1.
PossibleNumber extreme(std::span<const PossibleNumber> numbers, int sign) {
  PossibleNumber out = numbers[0];
  for (const PossibleNumber& n : numbers) {
    if (std::isnan(n.low) || std::isnan(out.low)) return single_number(kNaN);
    if (sign * n.low > sign * out.low) out.low = n.low;
    if (sign * n.high > sign * out.high) out.high = n.high;
  }
  return out;
}

PossibleNumber exponential(const PossibleNumber& n) {
  return {near(std::exp(n.low)).low, near(std::exp(n.high)).high, false};
}

PossibleNumber logarithm(const PossibleNumber& n) {
  if (!n.is_exact() && n.low <= 0) return kAnything;
  return {near(std::log(n.low)).low, near(std::log(n.high)).high, false};
}

PossibleNumber angle(const PossibleNumber& y, const PossibleNumber& x) {
  if ((y.is_exact() && x.is_exact()) || std::isnan(y.low) || std::isnan(x.low)) return near(std::atan2(y.low, x.low));
  return {-4, 4, false};
}

PossibleNumber value_of(const std::string& name, std::span<const PossibleNumber> given) {
  const PossibleNumber& n = given.front();
  if (name == "abs") return absolute(n);
  if (name == "sqrt") return root(n);
  if (name == "min") return extreme(given, -1);
  if (name == "max") return extreme(given, 1);
  if (name == "floor") return increasing(n, [](double v) { return std::floor(v); });
  if (name == "ceil") return increasing(n, [](double v) { return std::ceil(v); });
  if (name == "round") return increasing(n, [](double v) { return std::nearbyint(v); });
  if (name == "exp") return exponential(n);
  if (name == "log") return logarithm(n);
  if (name == "atan2") return angle(n, given.back());
  const PossibleNumber across = absolute(n), along = absolute(given.back());
  return root(combined('+', combined('*', across, across), combined('*', along, along)));
}

}  // namespace

PossibleNumber as_double(const PossibleNumber& n) {
  return {static_cast<Real>(static_cast<double>(n.low)), static_cast<Real>(static_cast<double>(n.high)), false};
}

PossibleNumber combined(char sign, PossibleNumber a, PossibleNumber b) {
  a = as_double(a), b = as_double(b);
  if (a.is_exact() && b.is_exact())
    return single_number(plain(sign, static_cast<double>(a.low), static_cast<double>(b.low)));
  if (sign == '/' && b.low <= 0 && b.high >= 0) return kAnything;
  PossibleNumber out{kInfinity, -kInfinity, false};
  for (const Real x : {a.low, a.high})
    for (const Real y : {b.low, b.high}) {
      const Real v = sign == '+' ? x + y : sign == '-' ? x - y : sign == '*' ? x * y : x / y;
      if (!std::isfinite(v)) return kAnything;
      const Real slack = 2 * kDouble * std::fabs(v) + 0x1p-1074L;
      out.low = std::min(out.low, v - slack), out.high = std::max(out.high, v + slack);
    }
  return out;
}

std::optional<bool> compared(const std::string& sign, const PossibleNumber& a, const PossibleNumber& b) {
  if (a.is_exact() && b.is_exact()) {
    const Real x = a.low, y = b.low;
    if (sign == "==") return x == y;
    if (sign == "!=") return x != y;
    if (sign == "<") return x < y;
    if (sign == "<=") return x <= y;
    if (sign == ">") return x > y;
    return x >= y;
  }
  const bool below = a.high<b.low, above = a.low> b.high;
  if (!below && !above) return std::nullopt;
  if (sign == "==") return false;
  if (sign == "!=") return true;
  return (sign[0] == '<') == below;
}

PossibleNumber function_of(const std::string& name, std::span<const PossibleNumber> arguments) {
  std::vector<PossibleNumber> given;
  bool is_exact = true;
  for (const PossibleNumber& argument : arguments) {
    given.push_back(as_double(argument));
    const PossibleNumber& n = given.back();
    // An argument whose range has several values may be NaN if the range is not finite.
    if (!n.is_exact() && !(std::isfinite(n.low) && std::isfinite(n.high))) return kAnything;
    is_exact = is_exact && n.is_exact();
  }
  const PossibleNumber out = value_of(name, given);
  // A range does not state the sign of a 0, on which 1 / 0 depends.
  if (!is_exact && out.low == 0 && out.high == 0) return {-0x1p-1074L, 0x1p-1074L, false};
  return out;
}

namespace {

constexpr int kRankOfComparisons = 4, kRankOfFunctions = 8;
constexpr const char* kOpenBetween = "between ";  ///< sign of a `between` whose `and` has not been read yet

int rank_of(const std::string& sign) {
  if (sign == "||") return 1;
  if (sign == "&&") return 2;
  if (sign == "!") return 3;
  if (sign == "+" || sign == "-") return 5;
  if (sign == "*" || sign == "/") return 6;
  if (sign == "-1") return 7;
  const bool is_function =
      std::isalpha(static_cast<unsigned char>(sign[0])) && sign != "in" && !sign.starts_with("between");
  return is_function ? kRankOfFunctions : kRankOfComparisons;
}

bool is_prefix(const std::string& sign) { return sign == "!" || sign == "-1"; }

bool continues_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.'; }

/// Returns whether the text begins with an operand, which may follow `not`.
bool begins_operand(std::string_view text) {
  if (text.empty() || text.starts_with("!=")) return false;
  return continues_word(text[0]) || text[0] == '(' || text[0] == '-' || text[0] == '!' || text[0] == '`';
}

/// Returns whether the last waiting operator after the last open parenthesis, arithmetic and functions left out, is a
/// `between` whose `and` has not been read yet.
template <class List>
bool is_open_between(const List& waiting) {
  for (auto last = waiting.rbegin(); last != waiting.rend() && last->sign != "("; ++last)
    if (rank_of(last->sign) <= kRankOfComparisons) return last->sign == kOpenBetween;
  return false;
}

std::optional<bool> opposite(std::optional<bool> truth) { return truth ? std::optional(!*truth) : std::nullopt; }

std::optional<bool> either(std::optional<bool> a, std::optional<bool> b) {
  if (a == true || b == true) return true;
  return a && b ? std::optional(false) : std::nullopt;
}

std::optional<bool> both(std::optional<bool> a, std::optional<bool> b) {
  return opposite(either(opposite(a), opposite(b)));
}

}  // namespace

PlainExpression::PlainExpression(std::string_view text) { read(text); }

/// Parses the text by Dijkstra's shunting-yard algorithm. A function and a list of `in` are operators whose operands
/// stand between parentheses.
void PlainExpression::read(std::string_view text) {
  struct Waiting {
    std::string sign;
    std::size_t parts = 2;
  };
  std::vector<Waiting> waiting;
  const auto put_last = [&] {
    postfix_.push_back({.sign = waiting.back().sign, .parts = waiting.back().parts});
    waiting.pop_back();
  };
  const auto put_from_rank = [&](int rank) {
    while (!waiting.empty() && waiting.back().sign != "(" && rank_of(waiting.back().sign) >= rank) put_last();
  };
  const auto put_to_parenthesis = [&] {
    while (waiting.back().sign != "(") put_last();
  };
  const auto put_name = [&](const std::string& name) {
    const auto known = std::ranges::find(names_, name);
    postfix_.push_back({.sign = {}, .is_name = true, .name = static_cast<std::size_t>(known - names_.begin())});
    if (known == names_.end()) names_.push_back(name);
  };
  bool operand_before = false;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (c == ' ' || c == '\t' || c == '\n') {
      ++at;
    } else if (std::isdigit(static_cast<unsigned char>(c)) || c == '.') {
      const std::string rest(text.substr(at));
      char* end = nullptr;
      const double value = std::strtod(rest.c_str(), &end);
      const auto length = static_cast<std::size_t>(end - rest.c_str());
      const bool digits = rest.find_first_not_of("0123456789") >= length && rest.size() >= length;
      PossibleNumber number = single_number(value);
      if (digits && std::strtold(rest.substr(0, length).c_str(), nullptr) < 0x1p64L)
        number = {std::strtold(rest.substr(0, length).c_str(), nullptr), 0, true}, number.high = number.low;
      postfix_.push_back({.sign = {}, .value = number});
      at += length, operand_before = true;
    } else if (std::isalpha(static_cast<unsigned char>(c)) || c == '_') {
      std::size_t end = at;
      while (end < text.size() && continues_word(text[end])) ++end;
      const std::string word(text.substr(at, end - at));
      const std::size_t next = std::min(text.find_first_not_of(" \t\n", end), text.size());
      at = end;
      if (operand_before && word == "and" && is_open_between(waiting)) {
        put_from_rank(kRankOfComparisons + 1);
        waiting.back().sign = "between";
        operand_before = false;
      } else if (operand_before || (word == "not" && begins_operand(text.substr(next)))) {
        // Adds an operator. In `a not in (1)`, `not` is pushed below `in`, which has a higher precedence.
        const std::string sign = word == "and" ? "&&" : word == "or" ? "||" : word == "not" ? "!" : word;
        if (operand_before) put_from_rank(sign == "!" ? kRankOfComparisons + 1 : rank_of(sign));
        waiting.push_back({sign == "between" ? kOpenBetween : sign, sign == "!" ? 1u : sign == "between" ? 3u : 2u});
        operand_before = word == "not" && operand_before;
      } else if (text.substr(next).starts_with("(")) {
        waiting.push_back({word, 0});
      } else {
        put_name(word);
        operand_before = true;
      }
    } else if (c == '`') {
      const std::size_t end = text.find('`', at + 1);
      put_name(std::string(text.substr(at + 1, end - at - 1)));
      at = end + 1, operand_before = true;
    } else if (c == '(') {
      waiting.push_back({"(", 1}), ++at, operand_before = false;
    } else if (c == ',') {
      put_to_parenthesis();
      ++waiting.back().parts, ++at, operand_before = false;
    } else if (c == ')') {
      put_to_parenthesis();
      const std::size_t parts = waiting.back().parts;
      waiting.pop_back(), ++at, operand_before = true;
      const bool is_list = !waiting.empty() && waiting.back().sign == "in";
      if (!is_list && (waiting.empty() || rank_of(waiting.back().sign) != kRankOfFunctions)) continue;
      waiting.back().parts = is_list ? parts + 1 : parts;
      put_last();
    } else {
      std::string sign(text.substr(at, 2));
      if (sign != "||" && sign != "&&" && sign != "==" && sign != "!=" && sign != "<=" && sign != ">=") sign.resize(1);
      at += sign.size();
      if (sign == "-" && !operand_before) sign = "-1";
      if (!is_prefix(sign)) put_from_rank(rank_of(sign));
      waiting.push_back({sign, is_prefix(sign) ? 1u : 2u}), operand_before = false;
    }
  }
  while (!waiting.empty()) put_last();
}

PlainExpression::Part PlainExpression::evaluate(std::span<const PossibleNumber> values) const {
  std::vector<Part> stack;
  for (const Token& token : postfix_) {
    Part part{.number = token.is_name ? values[token.name] : token.value, .is_literal = !token.is_name};
    if (!token.sign.empty()) part = result_of(token, std::span(stack).last(token.parts));
    stack.resize(stack.size() - token.parts);
    stack.push_back(part);
  }
  return stack.back();
}

PlainExpression::Part PlainExpression::result_of(const Token& token, std::span<const Part> parts) {
  const Part &left = parts.front(), &right = parts.back();
  const std::string& sign = token.sign;
  if (sign == "!") return {.number = {}, .truth = opposite(right.truth)};
  if (sign == "-1") {
    const bool keeps = right.is_literal && right.number.is_whole && right.number.low <= 0x1p63L;
    const PossibleNumber n = keeps ? right.number : as_double(right.number);
    return {.number = {-n.high, -n.low, keeps}, .is_literal = right.is_literal};
  }
  if (sign == "||") return {.number = {}, .truth = either(left.truth, right.truth)};
  if (sign == "&&") return {.number = {}, .truth = both(left.truth, right.truth)};
  if (sign == "+" || sign == "-" || sign == "*" || sign == "/")
    return {.number = combined(sign[0], left.number, right.number)};
  if (sign == "between")
    return {.number = {}, .truth = both(truth_of(">=", left, parts[1]), truth_of("<=", left, right))};
  if (sign == "in") {
    std::optional<bool> found = false;
    for (const Part& part : parts.subspan(1)) found = either(found, truth_of("==", left, part));
    return {.number = {}, .truth = found};
  }
  if (rank_of(sign) == kRankOfComparisons) return {.number = {}, .truth = truth_of(sign, left, right)};
  std::vector<PossibleNumber> arguments;
  for (const Part& part : parts) arguments.push_back(part.number);
  return {.number = function_of(sign, arguments)};
}

std::optional<bool> PlainExpression::truth_of(const std::string& sign, const Part& left, const Part& right) {
  const bool exact = left.number.is_whole && right.number.is_whole && !(left.is_literal && right.is_literal);
  return exact ? compared(sign, left.number, right.number)
               : compared(sign, as_double(left.number), as_double(right.number));
}

PossibleNumber PlainExpression::number(std::span<const PossibleNumber> values) const { return evaluate(values).number; }

std::optional<bool> PlainExpression::holds(std::span<const PossibleNumber> values) const {
  return evaluate(values).truth;
}

Estimate stored_number(const PossibleNumber& number, Storage storage) {
  if (storage == Storage::whole) {
    const bool stays = number.is_exact() && number.is_whole;
    const Real low = stays ? number.low : std::nearbyint(static_cast<double>(number.low));
    const Real high = stays ? number.high : std::nearbyint(static_cast<double>(number.high));
    return low == high ? exactly(low) : open();
  }
  if (number.is_exact()) {
    const auto rounded = static_cast<double>(number.low);
    return exactly(storage == Storage::single ? static_cast<double>(static_cast<float>(rounded)) : rounded);
  }
  const Real middle = number.low / 2 + number.high / 2, error = number.high / 2 - number.low / 2;
  if (!std::isfinite(middle)) return open();
  const Real rounding = storage == Storage::single ? kSingle : kDouble;
  return scalar(middle, error + 2 * rounding * (std::fabs(middle) + error) + 0x1p-149L);
}

}  // namespace pointsweep::formulas
