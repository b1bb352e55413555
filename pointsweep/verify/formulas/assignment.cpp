// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/assignment.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

namespace pointsweep::formulas {
namespace {

int rank_of(const std::string& sign) {
  if (sign == "||") return 1;
  if (sign == "&&") return 2;
  if (sign == "!") return 3;
  if (sign == "+" || sign == "-") return 5;
  if (sign == "*" || sign == "/") return 6;
  return sign == "-1" ? 7 : 4;
}

bool is_prefix(const std::string& sign) { return sign == "!" || sign == "-1"; }

PossibleNumber as_exact(Real value) { return {value, value, false}; }

/// Rounds the range to float64, the type in which numbers are combined.
PossibleNumber as_double(const PossibleNumber& n) {
  return {static_cast<Real>(static_cast<double>(n.low)), static_cast<Real>(static_cast<double>(n.high)), false};
}

double plain(char sign, double a, double b) {
  return sign == '+' ? a + b : sign == '-' ? a - b : sign == '*' ? a * b : a / b;
}

PossibleNumber combined(char sign, PossibleNumber a, PossibleNumber b) {
  a = as_double(a), b = as_double(b);
  if (a.is_exact() && b.is_exact())
    return as_exact(plain(sign, static_cast<double>(a.low), static_cast<double>(b.low)));
  const PossibleNumber anything{-kInfinity, kInfinity, false};
  if (sign == '/' && b.low <= 0 && b.high >= 0) return anything;
  PossibleNumber out{kInfinity, -kInfinity, false};
  for (const Real x : {a.low, a.high})
    for (const Real y : {b.low, b.high}) {
      const Real v = sign == '+' ? x + y : sign == '-' ? x - y : sign == '*' ? x * y : x / y;
      if (!std::isfinite(v)) return anything;
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

}  // namespace

PlainExpression::PlainExpression(std::string_view text) { read(text); }

/// Dijkstra's shunting yard.
void PlainExpression::read(std::string_view text) {
  std::vector<std::string> waiting;
  const auto put = [&](const std::string& sign) { postfix_.push_back({.sign = sign}); };
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
      PossibleNumber number = as_exact(value);
      if (digits && std::strtold(rest.substr(0, length).c_str(), nullptr) < 0x1p64L)
        number = {std::strtold(rest.substr(0, length).c_str(), nullptr), 0, true}, number.high = number.low;
      postfix_.push_back({.sign = {}, .value = number});
      at += length, operand_before = true;
    } else if (std::isalpha(static_cast<unsigned char>(c)) || c == '_') {
      std::size_t end = at;
      while (end < text.size() &&
             (std::isalnum(static_cast<unsigned char>(text[end])) || text[end] == '_' || text[end] == '.'))
        ++end;
      const std::string word(text.substr(at, end - at));
      const auto known = std::find(names_.begin(), names_.end(), word);
      postfix_.push_back({.sign = {}, .is_name = true, .name = static_cast<std::size_t>(known - names_.begin())});
      if (known == names_.end()) names_.push_back(word);
      at = end, operand_before = true;
    } else if (c == '(') {
      waiting.emplace_back("("), ++at, operand_before = false;
    } else if (c == ')') {
      while (waiting.back() != "(") put(waiting.back()), waiting.pop_back();
      waiting.pop_back(), ++at, operand_before = true;
    } else {
      std::string sign(text.substr(at, 2));
      if (sign != "||" && sign != "&&" && sign != "==" && sign != "!=" && sign != "<=" && sign != ">=") sign.resize(1);
      at += sign.size();
      if (sign == "-" && !operand_before) sign = "-1";
      if (!is_prefix(sign))
        while (!waiting.empty() && waiting.back() != "(" && rank_of(waiting.back()) >= rank_of(sign))
          put(waiting.back()), waiting.pop_back();
      waiting.push_back(sign), operand_before = false;
    }
  }
  for (; !waiting.empty(); waiting.pop_back()) put(waiting.back());
}

PlainExpression::Part PlainExpression::evaluate(std::span<const PossibleNumber> values) const {
  std::vector<Part> stack;
  const auto pop = [&] {
    Part part = stack.back();
    stack.pop_back();
    return part;
  };
  for (const Token& token : postfix_) {
    if (token.sign.empty()) {
      stack.push_back({.number = token.is_name ? values[token.name] : token.value, .is_literal = !token.is_name});
      continue;
    }
    const Part right = pop();
    if (token.sign == "!") {
      stack.push_back({.number = {}, .truth = right.truth ? std::optional(!*right.truth) : std::nullopt});
      continue;
    }
    if (token.sign == "-1") {
      const bool keeps = right.is_literal && right.number.is_whole && right.number.low < 0x1p63L;
      const PossibleNumber n = keeps ? right.number : as_double(right.number);
      stack.push_back({.number = {-n.high, -n.low, keeps}, .is_literal = right.is_literal});
      continue;
    }
    const Part left = pop();
    if (token.sign == "&&" || token.sign == "||") {
      const bool decides = token.sign == "||";
      Part out;
      if (left.truth == decides || right.truth == decides)
        out.truth = decides;
      else if (left.truth && right.truth)
        out.truth = !decides;
      stack.push_back(out);
    } else if (token.sign == "+" || token.sign == "-" || token.sign == "*" || token.sign == "/") {
      stack.push_back({.number = combined(token.sign[0], left.number, right.number)});
    } else {
      const bool exact = left.number.is_whole && right.number.is_whole && !(left.is_literal && right.is_literal);
      stack.push_back({.number = {},
                       .truth = exact ? compared(token.sign, left.number, right.number)
                                      : compared(token.sign, as_double(left.number), as_double(right.number))});
    }
  }
  return stack.back();
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
    return low == high ? Estimate{.value = {low, 0, 0}} : open();
  }
  if (number.is_exact())
    return {.value = {storage == Storage::single
                          ? static_cast<Real>(static_cast<float>(static_cast<double>(number.low)))
                          : static_cast<Real>(static_cast<double>(number.low)),
                      0, 0}};
  const Real middle = number.low / 2 + number.high / 2, error = number.high / 2 - number.low / 2;
  if (!std::isfinite(middle)) return open();
  const Real rounding = storage == Storage::single ? kSingle : kDouble;
  return {.value = {middle, 0, 0}, .error = error + 2 * rounding * (std::fabs(middle) + error) + 0x1p-149L};
}

}  // namespace pointsweep::formulas
