// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/possible_number.h"

#include <algorithm>
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

/// Returns the range of an increasing function on a range.
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

/// Returns the greatest of the numbers if `sign` is 1, the least if it is -1.
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
    // A value that is not known exactly may be NaN if its range is not finite.
    if (!n.is_exact() && !(std::isfinite(n.low) && std::isfinite(n.high))) return kAnything;
    is_exact = is_exact && n.is_exact();
  }
  const PossibleNumber out = value_of(name, given);
  // The sign of a 0 is not known, and 1 / 0 depends on it.
  if (!is_exact && out.low == 0 && out.high == 0) return {-0x1p-1074L, 0x1p-1074L, false};
  return out;
}

}  // namespace pointsweep::formulas
