// SPDX-License-Identifier: MIT
#include "pointsweep/verify/stage_formula.h"

#include <algorithm>
#include <limits>
#include <string>
#include <typeinfo>

#include "pointsweep/operators/color.h"
#include "pointsweep/operators/density.h"
#include "pointsweep/operators/density_clusters.h"
#include "pointsweep/operators/least_eigenentropy.h"
#include "pointsweep/operators/limits_from_attributes.h"
#include "pointsweep/operators/local_outlier_factor.h"
#include "pointsweep/operators/neighbor_rows.h"
#include "pointsweep/operators/neighborhood_size.h"
#include "pointsweep/operators/outliers.h"
#include "pointsweep/operators/radius_outliers.h"
#include "pointsweep/operators/set.h"
#include "pointsweep/operators/where.h"
#include "pointsweep/verify/formulas/colors.h"
#include "pointsweep/verify/formulas/crowding.h"
#include "pointsweep/verify/formulas/distances.h"
#include "pointsweep/verify/set_formula.h"
#include "pointsweep/verify/shape_formulas.h"

namespace pointsweep {
namespace {

using formulas::Estimate;
using formulas::Real;
using Estimates = std::vector<Estimate>;

Estimate exact_number(Real value) { return {.value = {value, 0, 0}}; }

class SizeFormula final : public StageFormula {
 public:
  Estimates evaluate(const FormulaInput& in) const override {
    return {exact_number(static_cast<Real>(in.neighbors.size())), formulas::farthest(in.place, in.neighbors)};
  }
};

class MeanDistanceFormula final : public StageFormula {
 public:
  explicit MeanDistanceFormula(bool of_open3d) : of_open3d_(of_open3d) {}
  Estimates evaluate(const FormulaInput& in) const override {
    return {formulas::mean_distance(in.place, in.neighbors, of_open3d_)};
  }

 private:
  bool of_open3d_;
};

formulas::OutlierProgram program_of(OutlierDefinition definition) {
  switch (definition) {
    case OutlierDefinition::pdal:
      return formulas::OutlierProgram::pdal;
    case OutlierDefinition::pcl:
      return formulas::OutlierProgram::pcl;
    case OutlierDefinition::open3d:
      return formulas::OutlierProgram::open3d;
    case OutlierDefinition::cloudcompare:
      return formulas::OutlierProgram::cloudcompare;
    case OutlierDefinition::pointsweep:
      break;
  }
  return formulas::OutlierProgram::pointsweep;
}

class OutlierFormula final : public StageFormula {
 public:
  OutlierFormula(const CloudThreshold& threshold, OutlierDefinition definition)
      : threshold_(threshold), program_(program_of(definition)) {}
  Estimates evaluate(const FormulaInput& in) const override {
    return {formulas::outlier(in.reads[0], threshold_.value, threshold_.error, program_)};
  }

 private:
  CloudThreshold threshold_;
  formulas::OutlierProgram program_;
};

class RadiusOutlierFormula final : public StageFormula {
 public:
  explicit RadiusOutlierFormula(const RadiusOutliers& op) : radius_(op.radius()), least_(op.min_neighbors()) {}
  Estimates evaluate(const FormulaInput& in) const override {
    return {formulas::radius_outlier(in.place, in.neighbors, radius_, least_)};
  }

 private:
  double radius_;
  std::size_t least_;
};

class DensityFormula final : public StageFormula {
 public:
  explicit DensityFormula(const Density& op) : radius_(op.radius()) {}
  Estimates evaluate(const FormulaInput& in) const override {
    const formulas::Densities d = formulas::densities(in.place, in.neighbors, radius_);
    return {d.surface, d.volume};
  }

 private:
  std::optional<double> radius_;
};

class CoreFormula final : public StageFormula {
 public:
  explicit CoreFormula(const CorePoints& op) : eps_(op.eps()), least_(static_cast<std::size_t>(op.min_points())) {}
  Estimates evaluate(const FormulaInput& in) const override {
    return {formulas::core_point(in.place, in.neighbors, eps_, least_)};
  }

 private:
  double eps_;
  std::size_t least_;
};

class KDistanceFormula final : public StageFormula {
 public:
  Estimates evaluate(const FormulaInput& in) const override { return {formulas::k_distance(in.place, in.neighbors)}; }
};

class ReachabilityFormula final : public StageFormula {
 public:
  Estimates evaluate(const FormulaInput& in) const override {
    return {formulas::reachability_density(in.place, in.neighbors, in.of_neighbors[0])};
  }
};

class DensityRatioFormula final : public StageFormula {
 public:
  Estimates evaluate(const FormulaInput& in) const override {
    return {formulas::local_outlier_factor(in.reads[0], in.of_neighbors[0])};
  }
};

class ColorFormula final : public StageFormula {
 public:
  explicit ColorFormula(const Color& op)
      : source_(op.source()),
        scale_(scale_of(op.options().map)),
        lo_(op.lo().value_or(0)),
        hi_(op.hi().value_or(0)),
        known_(scale_ == formulas::ColorScale::classes || op.lo().has_value()),
        widen_(op.bits() == 16 ? 257 : 1) {}
  Estimates evaluate(const FormulaInput& in) const override {
    const Estimate e = source_.attribute < 0 ? Estimate{.value = in.place.at, .error = in.place.error}
                                             : in.reads[static_cast<std::size_t>(source_.attribute)];
    if (!known_ || source_.component > 2 || e.is_open() || e.either_sign || e.may_be_undefined)
      return {formulas::open()};
    const Real v = source_.component == 0 ? e.value.x : source_.component == 1 ? e.value.y : e.value.z;
    const auto color = color_at(v), low = color_at(v - e.error), high = color_at(v + e.error);
    if (low != color || high != color) return {formulas::open()};
    return {Estimate{.value = {Real(widen_ * color[0]), Real(widen_ * color[1]), Real(widen_ * color[2])}}};
  }

 private:
  static formulas::ColorScale scale_of(ColorMap map) {
    return map == ColorMap::turbo     ? formulas::ColorScale::turbo
           : map == ColorMap::gray    ? formulas::ColorScale::gray
           : map == ColorMap::classes ? formulas::ColorScale::classes
                                      : formulas::ColorScale::viridis;
  }
  std::array<int, 3> color_at(Real v) const { return formulas::color_of(static_cast<double>(v), scale_, lo_, hi_); }

  NamedValues::Source source_;
  formulas::ColorScale scale_;
  double lo_, hi_;
  bool known_;
  int widen_;
};

class GraphFormula final : public StageFormula {
 public:
  explicit GraphFormula(const Contract& c)
      : k_(c.makes.front().fields.size()), distances_(c.makes.size() > 1), type_(c.makes.front().type) {}
  Estimates evaluate(const FormulaInput& in) const override {
    const formulas::GraphRow row = formulas::graph_row(in.place, in.neighbors, in.rows);
    const Real none = type_ == Type::u64 ? static_cast<Real>(std::numeric_limits<std::uint64_t>::max())
                                         : static_cast<Real>(std::numeric_limits<std::uint32_t>::max());
    Estimates rows(wide(), exact_number(none)), lengths(wide(), exact_number(std::numeric_limits<Real>::quiet_NaN()));
    for (std::size_t j = 0; j < std::min(k_, row.neighbors.size()); ++j) {
      rows[j] = row.certain ? exact_number(static_cast<Real>(in.rows[row.neighbors[j].index])) : formulas::open();
      lengths[j] = row.neighbors[j].distance;
    }
    Estimates all = as_attribute(rows);
    if (distances_)
      for (const Estimate& e : as_attribute(lengths)) all.push_back(e);
    return all;
  }

 private:
  std::size_t wide() const { return std::max<std::size_t>(k_, 3); }
  /// Up to three numbers are one estimate.
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

}  // namespace

std::unique_ptr<StageFormula> formula_of(const Operator& op, const CloudThreshold& threshold) {
  // Exactly these classes: one derived from them may mean something else.
  const std::type_info& type = typeid(op);
  const Contract contract = op.contract();
  if (auto shape = shape_formula_of(op)) return shape;
  if (type == typeid(NeighborhoodSize)) return std::make_unique<SizeFormula>();
  if (type == typeid(RadiusOutliers))
    return std::make_unique<RadiusOutlierFormula>(static_cast<const RadiusOutliers&>(op));
  if (type == typeid(Density)) return std::make_unique<DensityFormula>(static_cast<const Density&>(op));
  if (type == typeid(KDistance)) return std::make_unique<KDistanceFormula>();
  if (type == typeid(ReachabilityDensity)) return std::make_unique<ReachabilityFormula>();
  if (type == typeid(DensityRatio)) return std::make_unique<DensityRatioFormula>();
  if (type == typeid(MeanDistance))
    return std::make_unique<MeanDistanceFormula>(static_cast<const MeanDistance&>(op).counts_point());
  if (type == typeid(Outlier))
    return std::make_unique<OutlierFormula>(threshold, static_cast<const Outlier&>(op).definition());
  if (type == typeid(CorePoints)) return std::make_unique<CoreFormula>(static_cast<const CorePoints&>(op));
  if (type == typeid(Color)) return std::make_unique<ColorFormula>(static_cast<const Color&>(op));
  if (type == typeid(SetAttribute)) return set_formula_of(static_cast<const SetAttribute&>(op));
  if (type == typeid(Where)) return condition_formula_of(static_cast<const Where&>(op));
  if (type == typeid(NeighborRows)) return std::make_unique<GraphFormula>(contract);
  return nullptr;
}

RuleFormula formula_of(const NeighborhoodRule& rule) {
  if (typeid(rule) == typeid(LeastEigenentropy)) {
    const std::size_t least = static_cast<const LeastEigenentropy&>(rule).least();
    return [least](const formulas::Place& p, std::span<const formulas::Place> neighbors, std::span<const double>) {
      return formulas::of_least_eigenentropy(p, neighbors, least);
    };
  }
  if (typeid(rule) != typeid(LimitsFromAttributes)) return {};
  const AttributeLimits& limits = static_cast<const LimitsFromAttributes&>(rule).limits();
  const bool k = !limits.k.empty(), radius = !limits.radius.empty();
  return [k, radius](const formulas::Place& p, std::span<const formulas::Place> neighbors,
                     std::span<const double> values) {
    return formulas::within_limits(p, neighbors, k ? std::optional(values[0]) : std::nullopt,
                                   radius ? std::optional(values[k ? 1 : 0]) : std::nullopt);
  };
}

}  // namespace pointsweep
