// SPDX-License-Identifier: MIT
/// The evaluation of expressions, and the functions that they call.
#include <algorithm>
#include <cmath>

#include "pointsweep/math/exp.h"
#include "pointsweep/operators/expressions/expression.h"

namespace pointsweep {
namespace {

using Arguments = std::span<const double>;

/// Returns the argument that comes first by the order `precedes`; NaN if an argument is NaN. The first of equal
/// arguments counts.
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

using Node = Expression::Node;

/// Evaluates the nodes for one batch.
class ExpressionEvaluator {
 public:
  ExpressionEvaluator(std::span<const ExpressionValues> values, std::size_t size) : values_(values), size_(size) {}

  std::vector<std::uint8_t> condition(const Node& node) const {
    switch (node.operation) {
      case Operation::no: {
        std::vector<std::uint8_t> out = condition(node.parts[0]);
        for (auto& v : out) v = v == 0;
        return out;
      }
      case Operation::both:
      case Operation::either: {
        std::vector<std::uint8_t> out = condition(node.parts[0]);
        const std::vector<std::uint8_t> right = condition(node.parts[1]);
        const bool both = node.operation == Operation::both;
        for (std::size_t i = 0; i < size_; ++i) out[i] = both ? out[i] & right[i] : out[i] | right[i];
        return out;
      }
      case Operation::among: {
        std::vector<std::uint8_t> out(size_, 0);
        for (std::size_t p = 1; p < node.parts.size(); ++p) {
          const std::vector<std::uint8_t> is_equal = compared(Operation::equal, node.parts[0], node.parts[p]);
          for (std::size_t i = 0; i < size_; ++i) out[i] |= is_equal[i];
        }
        return out;
      }
      case Operation::between: {
        std::vector<std::uint8_t> out = compared(Operation::greater_equal, node.parts[0], node.parts[1]);
        const std::vector<std::uint8_t> below = compared(Operation::less_equal, node.parts[0], node.parts[2]);
        for (std::size_t i = 0; i < size_; ++i) out[i] &= below[i];
        return out;
      }
      default:
        return compared(node.operation, node.parts[0], node.parts[1]);
    }
  }

  bool is_whole(const Node& node) const {
    if (node.operation == Operation::name) return values_[node.name].whole != nullptr;
    return is_literal(node) && node.whole.has_value();
  }

  std::vector<WholeNumber> wholes(const Node& node) const {
    if (is_literal(node)) return std::vector<WholeNumber>(size_, *node.whole);
    std::vector<WholeNumber> out(size_);
    const ExpressionValues& v = values_[node.name];
    for (std::size_t i = 0; i < size_; ++i)
      out[i] = v.is_signed ? WholeNumber{static_cast<std::int64_t>(v.whole[i])} : WholeNumber{v.whole[i]};
    return out;
  }

  std::vector<double> reals(const Node& node) const {
    if (is_literal(node)) return std::vector<double>(size_, node.number);
    if (node.operation == Operation::name) {
      const ExpressionValues& v = values_[node.name];
      if (v.whole == nullptr) return {v.real, v.real + size_};
      std::vector<double> out(size_);
      for (std::size_t i = 0; i < size_; ++i)
        out[i] =
            v.is_signed ? static_cast<double>(static_cast<std::int64_t>(v.whole[i])) : static_cast<double>(v.whole[i]);
      return out;
    }
    if (node.operation == Operation::function) return values_of_function(node);
    std::vector<double> out = reals(node.parts[0]);
    if (node.operation == Operation::negate) {
      for (double& v : out) v = -v;
      return out;
    }
    const std::vector<double> right = reals(node.parts[1]);
    for (std::size_t i = 0; i < size_; ++i) out[i] = combined(node.operation, out[i], right[i]);
    return out;
  }

 private:
  static bool is_literal(const Node& node) { return node.operation == Operation::number; }
  static double combined(Operation operation, double a, double b) {
    switch (operation) {
      case Operation::add:
        return a + b;
      case Operation::subtract:
        return a - b;
      case Operation::multiply:
        return a * b;
      default:
        return a / b;
    }
  }

  std::vector<double> values_of_function(const Node& node) const {
    std::vector<std::vector<double>> parts;
    for (const Node& part : node.parts) parts.push_back(reals(part));
    std::vector<double> out(size_), arguments(parts.size());
    for (std::size_t i = 0; i < size_; ++i) {
      for (std::size_t p = 0; p < parts.size(); ++p) arguments[p] = parts[p][i];
      out[i] = node.function->value(arguments);
    }
    return out;
  }

  std::vector<std::uint8_t> compared(Operation operation, const Node& a, const Node& b) const {
    if (is_whole(a) && is_whole(b) && !(is_literal(a) && is_literal(b)))
      return compared(operation, wholes(a), wholes(b));
    return compared(operation, reals(a), reals(b));
  }

  template <class T>
  std::vector<std::uint8_t> compared(Operation operation, const std::vector<T>& a, const std::vector<T>& b) const {
    std::vector<std::uint8_t> out(size_);
    const auto set = [&](auto holds) {
      for (std::size_t i = 0; i < size_; ++i) out[i] = holds(a[i], b[i]);
    };
    switch (operation) {
      case Operation::equal:
        set([](T x, T y) { return x == y; });
        break;
      case Operation::unequal:
        set([](T x, T y) { return x != y; });
        break;
      case Operation::less:
        set([](T x, T y) { return x < y; });
        break;
      case Operation::less_equal:
        set([](T x, T y) { return x <= y; });
        break;
      case Operation::greater:
        set([](T x, T y) { return x > y; });
        break;
      default:
        set([](T x, T y) { return x >= y; });
    }
    return out;
  }

  std::span<const ExpressionValues> values_;
  std::size_t size_;
};

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

void Expression::evaluate_number(std::span<const ExpressionValues> values, std::span<double> values_of_points) const {
  std::ranges::copy(ExpressionEvaluator(values, values_of_points.size()).reals(*root_), values_of_points.begin());
}

bool Expression::is_whole(std::span<const ExpressionValues> values) const {
  return ExpressionEvaluator(values, 0).is_whole(*root_);
}

void Expression::evaluate_whole(std::span<const ExpressionValues> values,
                                std::span<WholeNumber> values_of_points) const {
  std::ranges::copy(ExpressionEvaluator(values, values_of_points.size()).wholes(*root_), values_of_points.begin());
}

void Expression::evaluate(std::span<const ExpressionValues> values, std::span<std::uint8_t> kept) const {
  std::ranges::copy(ExpressionEvaluator(values, kept.size()).condition(*root_), kept.begin());
}

}  // namespace pointsweep
