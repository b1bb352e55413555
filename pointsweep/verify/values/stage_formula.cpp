// SPDX-License-Identifier: MIT
#include "pointsweep/verify/values/stage_formula.h"

#include <algorithm>
#include <charconv>

#include "pointsweep/fail.h"
#include "pointsweep/operators/expressions/named_values.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/verify/formulas/colors.h"
#include "pointsweep/verify/formulas/thinning.h"

namespace pointsweep {
namespace {

using formulas::Estimate;
using formulas::exactly;
using formulas::Real;

StageFormula size_formula(const FormulaSetup&) {
  return [](const FormulaInput& in) {
    return Estimates{exactly(static_cast<Real>(in.neighbors.size())), formulas::farthest(in.place, in.neighbors)};
  };
}

StageFormula mean_distance_formula(const FormulaSetup& stage) {
  return [of_open3d = stage.options.word("definition") == "open3d"](const FormulaInput& in) {
    return Estimates{formulas::mean_distance(in.place, in.neighbors, of_open3d)};
  };
}

formulas::OutlierProgram program_of(std::string_view definition) {
  using Program = formulas::OutlierProgram;
  if (definition == "pdal") return Program::pdal;
  if (definition == "pcl") return Program::pcl;
  if (definition == "open3d") return Program::open3d;
  if (definition == "cloudcompare") return Program::cloudcompare;
  return Program::pointsweep;
}

StageFormula outlier_formula(const FormulaSetup& stage) {
  return [threshold = stage.threshold, program = program_of(stage.options.word("definition"))](const FormulaInput& in) {
    return Estimates{formulas::outlier(in.reads[0], threshold.value, threshold.error, program)};
  };
}

StageFormula radius_outlier_formula(const FormulaSetup& stage) {
  return
      [radius = stage.options.number("radius"), least = stage.options.whole("min_neighbors")](const FormulaInput& in) {
        return Estimates{formulas::radius_outlier(in.place, in.neighbors, radius, least)};
      };
}

StageFormula density_formula(const FormulaSetup& stage) {
  return [radius = stage.options.number_if_given("radius")](const FormulaInput& in) {
    const formulas::Densities d = formulas::densities(in.place, in.neighbors, radius);
    return Estimates{d.surface, d.volume};
  };
}

StageFormula core_formula(const FormulaSetup& stage) {
  return [eps = stage.options.number("eps"), least = stage.options.whole("min_points")](const FormulaInput& in) {
    return Estimates{formulas::core_point(in.place, in.neighbors, eps, least)};
  };
}

StageFormula k_distance_formula(const FormulaSetup&) {
  return [](const FormulaInput& in) { return Estimates{formulas::k_distance(in.place, in.neighbors)}; };
}

StageFormula reachability_formula(const FormulaSetup&) {
  return [](const FormulaInput& in) {
    return Estimates{formulas::reachability_density(in.place, in.neighbors, in.of_neighbors[0])};
  };
}

StageFormula density_ratio_formula(const FormulaSetup&) {
  return
      [](const FormulaInput& in) { return Estimates{formulas::local_outlier_factor(in.reads[0], in.of_neighbors[0])}; };
}

/// Returns the formula of head(): 1 for the first `number` rows, counted over all inputs; 0 for all others.
StageFormula head_formula(const FormulaSetup& stage) {
  return [number = static_cast<Real>(stage.options.whole("number"))](const FormulaInput& in) {
    return Estimates{exactly(in.reads.front().value.x < number ? 1 : 0)};
  };
}

constexpr std::uint64_t kPartsSeed = 0x7061727473;  // "parts" in ASCII

StageFormula part_formula(const FormulaSetup& stage) {
  return [parts = stage.options.whole("number"), seed = stage.options.whole("seed")](const FormulaInput& in) {
    const formulas::Vector& p = in.place.at;
    if (in.place.error > 0) return Estimates{formulas::open()};
    if (!formulas::is_finite(p)) return Estimates{formulas::undefined()};
    const formulas::Coordinates at = {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
    return Estimates{exactly(static_cast<Real>(formulas::part_of(formulas::hash_of(at, seed + kPartsSeed), parts)))};
  };
}

class ColorFormula {
 public:
  explicit ColorFormula(const FormulaSetup& stage)
      : source_(read_of(stage.options.word("by"), stage.contract.reads)),
        scale_(scale_of(stage.options.word("map"))),
        widen_(stage.contract.makes.front().type == Type::u16 ? 257 : 1) {
    if (scale_ == formulas::ColorScale::classes) return;
    if (!stage.options.has("range")) return;
    const std::vector<double> range = stage.options.numbers("range");
    lo_ = range.at(0), hi_ = range.at(1);
  }
  Estimates operator()(const FormulaInput& in) const {
    const Estimate e = estimate_of(source_, in);
    const bool known = scale_ == formulas::ColorScale::classes || lo_;
    if (!known || source_.component > 2 || e.is_open() || e.either_sign || e.may_be_undefined)
      return {formulas::open()};
    const Real v = e.value[source_.component];
    const auto color = color_at(v), low = color_at(v - e.error), high = color_at(v + e.error);
    if (low != color || high != color) return {formulas::open()};
    return {Estimate{.value = {Real(widen_ * color[0]), Real(widen_ * color[1]), Real(widen_ * color[2])}}};
  }

 private:
  static formulas::ColorScale scale_of(std::string_view map) {
    return map == "turbo"     ? formulas::ColorScale::turbo
           : map == "gray"    ? formulas::ColorScale::gray
           : map == "classes" ? formulas::ColorScale::classes
                              : formulas::ColorScale::viridis;
  }
  std::array<int, 3> color_at(Real v) const {
    return formulas::color_of(static_cast<double>(v), scale_, lo_.value_or(0), hi_.value_or(0));
  }

  ReadValue source_;
  formulas::ColorScale scale_;
  std::optional<double> lo_ = {}, hi_ = {};  ///< ends of the scale; absent if not known yet, and for classes
  int widen_;
};

class GraphFormula {
 public:
  explicit GraphFormula(const FormulaSetup& stage)
      : k_(stage.contract.makes.front().fields.size()),
        distances_(stage.contract.makes.size() > 1),
        type_(stage.contract.makes.front().type) {}
  Estimates operator()(const FormulaInput& in) const {
    const formulas::GraphRow row = formulas::graph_row(in.place, in.neighbors, in.rows);
    const Real none = type_ == Type::u64 ? static_cast<Real>(std::numeric_limits<std::uint64_t>::max())
                                         : static_cast<Real>(std::numeric_limits<std::uint32_t>::max());
    Estimates rows(wide(), exactly(none)), lengths(wide(), exactly(formulas::kNaN));
    for (std::size_t j = 0; j < std::min(k_, row.neighbors.size()); ++j) {
      rows[j] = row.certain ? exactly(static_cast<Real>(in.rows[row.neighbors[j].index])) : formulas::open();
      lengths[j] = row.neighbors[j].distance;
    }
    Estimates all = as_attribute(rows);
    if (distances_)
      for (const Estimate& e : as_attribute(lengths)) all.push_back(e);
    return all;
  }

 private:
  std::size_t wide() const { return std::max<std::size_t>(k_, 3); }
  /// Returns up to three numbers joined into one estimate; more numbers are returned unchanged.
  Estimates as_attribute(const Estimates& numbers) const {
    if (k_ > 3) return numbers;
    Estimate one{.value = {numbers[0].value.x, numbers[1].value.x, numbers[2].value.x}};
    for (std::size_t j = 0; j < k_; ++j) one.error += numbers[j].error;
    return {one};
  }

  std::size_t k_;
  bool distances_;
  Type type_;
};

const std::vector<NamedFormula>& all_formulas() {
  static const std::vector<NamedFormula> all = [] {
    std::vector<NamedFormula> list = {{"neighborhood_size", size_formula},
                                      {"ror", radius_outlier_formula},
                                      {"density", density_formula},
                                      {"k_distance", k_distance_formula},
                                      {"reachability_density", reachability_formula},
                                      {"density_ratio", density_ratio_formula},
                                      {"mean_distance", mean_distance_formula},
                                      {"outlier", outlier_formula},
                                      {"core", core_formula},
                                      {"color", formula_made<ColorFormula>},
                                      {"parts", part_formula},
                                      {"head", head_formula},
                                      {"neighbors", formula_made<GraphFormula>}};
    for (const auto& more : {shape_formulas(), expression_formulas()})
      list.insert(list.end(), more.begin(), more.end());
    return list;
  }();
  return all;
}

}  // namespace

const OptionValue* NamedOptions::find(std::string_view name) const {
  const auto at = std::ranges::find(all_, name, &Option::name);
  return at == all_.end() ? nullptr : &at->value;
}

template <class T>
const T& NamedOptions::value(std::string_view name) const {
  const OptionValue* const found = find(name);
  if (found == nullptr || !std::holds_alternative<T>(*found))
    fail_usage(
        "verify: '{}' has no option '{}' of the kind that the operator of the library has; an operator of your "
        "own needs a name that no operator of the library has.",
        owner_, name);
  return std::get<T>(*found);
}

double NamedOptions::number(std::string_view name) const { return value<double>(name); }
std::uint64_t NamedOptions::whole(std::string_view name) const { return value<std::uint64_t>(name); }
const std::string& NamedOptions::word(std::string_view name) const { return value<std::string>(name); }
Vec3 NamedOptions::point(std::string_view name) const { return value<Vec3>(name); }

std::vector<double> NamedOptions::numbers(std::string_view name) const {
  const std::string& list = word(name);
  std::vector<double> numbers;
  const char* at = list.data();
  const char* const end = at + list.size();
  for (double number = 0; at < end; ++at) {
    const auto [next, error] = std::from_chars(at, end, number);
    if (error != std::errc()) break;
    numbers.push_back(number);
    at = next;
  }
  return numbers;
}

FormulaSetup setup_of(const Operator& op) { return {{op.name(), op.declared_options()}, op.contract()}; }

bool has_stage_formula(const Operator& op) {
  return std::ranges::find(all_formulas(), op.name(), &NamedFormula::name) != all_formulas().end();
}

StageFormula formula_of(const Operator& op, const CloudThreshold& threshold) {
  const auto found = std::ranges::find(all_formulas(), op.name(), &NamedFormula::name);
  if (found == all_formulas().end()) return {};
  FormulaSetup stage = setup_of(op);
  stage.threshold = threshold;
  return found->make(stage);
}

RuleFormula formula_of(const NeighborhoodRule& rule) {
  const NamedOptions options("knn", rule.options());
  if (options.has("adaptive") && options.word("adaptive") == "eigenentropy") {
    const std::size_t least = options.whole("k_min");
    return [least](const formulas::Place& p, std::span<const formulas::Place> neighbors, std::span<const double>) {
      return formulas::of_least_eigenentropy(p, neighbors, least);
    };
  }
  const bool k = options.has("k_from"), radius = options.has("radius_from");
  if (!k && !radius) return {};
  return [k, radius](const formulas::Place& p, std::span<const formulas::Place> neighbors,
                     std::span<const double> values) {
    return formulas::within_limits(p, neighbors, k ? std::optional(values[0]) : std::nullopt,
                                   radius ? std::optional(values[k ? 1 : 0]) : std::nullopt);
  };
}

ReadValue read_of(const std::string& name, const std::vector<Attribute>& reads) {
  if (const MeantValue meant = value_in_expression(name, Schema{}, reads); meant.made != nullptr)
    return {static_cast<int>(meant.made - reads.data()), meant.component};
  return {-1, static_cast<std::size_t>(library_name_of(name).front() - 'x')};
}

formulas::Estimate estimate_of(const ReadValue& value, const FormulaInput& in) {
  if (value.attribute < 0) return {.value = in.place.at, .error = in.place.error};
  return in.reads[static_cast<std::size_t>(value.attribute)];
}

}  // namespace pointsweep
