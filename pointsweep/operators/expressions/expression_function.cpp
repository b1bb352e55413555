// SPDX-License-Identifier: MIT
#include "pointsweep/operators/expressions/expression_function.h"

#include <algorithm>
#include <cmath>

#include "pointsweep/math/elementary.h"

namespace pointsweep {
namespace {

using Arguments = std::span<const double>;

/// Returns the argument that `precedes` all others, the first of equal arguments; NaN if an argument is NaN.
template <class Precedes>
double first_by(Arguments arguments, Precedes precedes) {
  double first = arguments[0];
  for (const double v : arguments)
    if (std::isnan(v) || precedes(v, first)) first = v;
  return first;
}

/// The functions, in float64. log, exp and atan2 are this library's own, of plain IEEE operations: the C library does
/// not guarantee the bits of its results.
constexpr ExpressionFunction kFunctions[] = {
    {"abs", 1, 1, [](Arguments a) { return std::fabs(a[0]); }},
    {"sqrt", 1, 1, [](Arguments a) { return std::sqrt(a[0]); }},
    {"min", 2, 100, [](Arguments a) { return first_by(a, [](double v, double w) { return v < w; }); }},
    {"max", 2, 100, [](Arguments a) { return first_by(a, [](double v, double w) { return v > w; }); }},
    {"floor", 1, 1, [](Arguments a) { return std::floor(a[0]); }},
    {"ceil", 1, 1, [](Arguments a) { return std::ceil(a[0]); }},
    {"round", 1, 1, [](Arguments a) { return std::nearbyint(a[0]); }},
    {"hypot", 2, 2, [](Arguments a) { return std::sqrt(a[0] * a[0] + a[1] * a[1]); }},
    {"log", 1, 1, [](Arguments a) { return logarithm(a[0]); }},
    {"exp", 1, 1, [](Arguments a) { return exponential(a[0]); }},
    {"atan2", 2, 2, [](Arguments a) { return arctangent2(a[0], a[1]); }}};

}  // namespace

const ExpressionFunction* expression_function(std::string_view name) {
  const auto found = std::ranges::find(kFunctions, name, &ExpressionFunction::name);
  return found == std::end(kFunctions) ? nullptr : found;
}

std::string names_of_functions() {
  std::string names;
  for (const ExpressionFunction& function : kFunctions) names.append(names.empty() ? "" : " ").append(function.name);
  return names;
}

}  // namespace pointsweep
