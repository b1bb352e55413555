// SPDX-License-Identifier: MIT
#include "pointsweep/verify/stage_formula.h"

#include <algorithm>
#include <limits>
#include <string>
#include <typeinfo>

#include "pointsweep/operators/color.h"
#include "pointsweep/operators/curvature.h"
#include "pointsweep/operators/density.h"
#include "pointsweep/operators/fair.h"
#include "pointsweep/operators/features.h"
#include "pointsweep/operators/least_eigenentropy.h"
#include "pointsweep/operators/limits_from_attributes.h"
#include "pointsweep/operators/local_outlier_factor.h"
#include "pointsweep/operators/neighbor_rows.h"
#include "pointsweep/operators/neighborhood_size.h"
#include "pointsweep/operators/normals.h"
#include "pointsweep/operators/outliers.h"
#include "pointsweep/operators/radius_outliers.h"
#include "pointsweep/operators/set.h"
#include "pointsweep/operators/splats.h"
#include "pointsweep/verify/formulas/assignment.h"
#include "pointsweep/verify/formulas/colors.h"
#include "pointsweep/verify/formulas/crowding.h"
#include "pointsweep/verify/formulas/curvature.h"
#include "pointsweep/verify/formulas/distances.h"
#include "pointsweep/verify/formulas/fairing.h"
#include "pointsweep/verify/formulas/features.h"
#include "pointsweep/verify/formulas/normal.h"
#include "pointsweep/verify/formulas/splat.h"

namespace pointsweep {
namespace {

using formulas::Estimate;
using formulas::Real;
using Estimates = std::vector<Estimate>;

/// Place of an attribute in a list of a contract that has it.
std::size_t place_in(const std::vector<Attribute>& list, const Attribute& wanted) {
  const auto is_wanted = [&](const Attribute& a) { return a.name == wanted.name; };
  return static_cast<std::size_t>(std::find_if(list.begin(), list.end(), is_wanted) - list.begin());
}

Estimate exact_number(Real value) { return {.value = {value, 0, 0}}; }

class NormalFormula final : public StageFormula {
 public:
  explicit NormalFormula(const NormalsOptions& options) : options_(options) {}
  Estimates evaluate(const FormulaInput& in) const override {
    using Side = formulas::Facing::Side;
    formulas::Facing facing;
    if (options_.orient == Orient::up) facing.side = Side::up;
    if (options_.orient == Orient::viewpoint) facing.side = Side::viewpoint;
    facing.viewpoint = {options_.viewpoint.x, options_.viewpoint.y, options_.viewpoint.z};
    if (options_.orient == Orient::input) facing.side = Side::like, facing.like = in.reads[0];
    return {formulas::normal(in.place, in.neighbors, facing)};
  }

 private:
  NormalsOptions options_;
};

class CurvatureFormula final : public StageFormula {
 public:
  explicit CurvatureFormula(const Contract& c)
      : own_(place_in(c.reads, normal_attribute())), near_(place_in(c.reads_neighbors, normal_attribute())) {}
  Estimates evaluate(const FormulaInput& in) const override {
    const formulas::Curvatures c = formulas::curvature(in.place, in.reads[own_], in.neighbors, in.of_neighbors[near_]);
    return {
        c.k1, c.k2, c.k1_direction, c.mean, c.gaussian, c.rms, c.absolute, c.surface_variation, c.normal_eigenvalues};
  }

 private:
  std::size_t own_, near_;
};

class SplatFormula final : public StageFormula {
 public:
  SplatFormula(const Contract& c, bool curved)
      : curved_(curved),
        normal_(place_in(c.reads, normal_attribute())),
        k1_(place_in(c.reads, k1_attribute())),
        k2_(place_in(c.reads, k2_attribute())),
        direction_(place_in(c.reads, k1_direction_attribute())) {}
  Estimates evaluate(const FormulaInput& in) const override {
    formulas::CurvatureHere here;
    if (curved_) here = {in.reads[k1_], in.reads[k2_], in.reads[direction_]};
    const formulas::Splat s = formulas::splat(in.place, in.reads[normal_], in.neighbors, curved_ ? &here : nullptr);
    return {s.axis, s.length, s.ratio};
  }

 private:
  bool curved_;
  std::size_t normal_, k1_, k2_, direction_;
};

class FairFormula final : public StageFormula {
 public:
  FairFormula(const Contract& c, const FairOptions& options)
      : options_(options),
        own_length_(place_in(c.reads, splat_length_attribute())),
        own_ratio_(place_in(c.reads, splat_ratio_attribute())),
        normal_(place_in(c.reads_neighbors, normal_attribute())),
        length_(place_in(c.reads_neighbors, splat_length_attribute())),
        ratio_(place_in(c.reads_neighbors, splat_ratio_attribute())) {}
  Estimates evaluate(const FormulaInput& in) const override {
    std::vector<formulas::Surfel> neighbors;
    for (std::size_t j = 0; j < in.neighbors.size(); ++j)
      neighbors.push_back(
          {in.neighbors[j], in.of_neighbors[normal_][j], in.of_neighbors[length_][j], in.of_neighbors[ratio_][j]});
    const formulas::Surfel own{in.place, {}, in.reads[own_length_], in.reads[own_ratio_]};
    return {formulas::faired(own, neighbors, options_.f, options_.g)};
  }

 private:
  FairOptions options_;
  std::size_t own_length_, own_ratio_, normal_, length_, ratio_;
};

class FeaturesFormula final : public StageFormula {
 public:
  explicit FeaturesFormula(const Features& op) : made_(op.made()), with_point_(op.options().with_point) {
    const EigenvalueScale scale = op.options().eigenvalues;
    lambda_ = scale == EigenvalueScale::raw    ? formulas::Lambda::raw
              : scale == EigenvalueScale::root ? formulas::Lambda::root
                                               : formulas::Lambda::normalized;
  }
  Estimates evaluate(const FormulaInput& in) const override {
    const formulas::Features f = formulas::features(in.place, in.neighbors, lambda_, with_point_);
    const Estimate all[kFeatures] = {f.linearity,     f.planarity,     f.sphericity,         f.omnivariance,
                                     f.anisotropy,    f.eigenentropy,  f.eigenvalue_sum,     f.surface_variation,
                                     f.verticality,   f.moment1_axis1, f.moment1_axis2,      f.moment2_axis1,
                                     f.moment2_axis2, f.height_range,  f.number_of_neighbors};
    Estimates made;
    for (const Feature feature : made_) made.push_back(all[static_cast<std::size_t>(feature)]);
    return made;
  }

 private:
  std::vector<Feature> made_;
  bool with_point_;
  formulas::Lambda lambda_;
};

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

class AssignmentFormula final : public StageFormula {
 public:
  explicit AssignmentFormula(const SetAttribute& op)
      : value_(op.assignment().value.text()),
        value_sources_(sources_of(value_, op.assignment().value, op.value_names(), op.first_of_value())),
        old_(op.old_value()),
        component_(op.component()),
        width_(op.target().fields.size()),
        moves_(op.target().name == position_attribute().name),
        storage_(op.range().is_whole             ? formulas::Storage::whole
                 : op.target().type == Type::f32 ? formulas::Storage::single
                                                 : formulas::Storage::real) {
    if (!op.assignment().condition) return;
    condition_.emplace(op.assignment().condition->text());
    condition_sources_ =
        sources_of(*condition_, *op.assignment().condition, op.condition_names(), op.first_of_condition());
  }
  Estimates evaluate(const FormulaInput& in) const override {
    std::optional<bool> holds = true;
    if (condition_) holds = condition_->holds(values_of(condition_sources_, in));
    if (!holds) return {formulas::open()};
    Estimate made = old_ ? in.reads[*old_] : Estimate{};
    if (moves_) made = {.value = in.place.at, .error = in.place.error};
    if (!*holds) return {made};
    const Estimate assigned = formulas::stored_number(value_.number(values_of(value_sources_, in)), storage_);
    if (made.either_sign || component_ > 2 || assigned.is_open()) return {formulas::open()};
    (component_ == 0 ? made.value.x : component_ == 1 ? made.value.y : made.value.z) = assigned.value.x;
    made.error = is_alone() ? assigned.error : made.error + assigned.error;
    if (is_alone()) made.may_be_undefined = false;
    return {made};
  }

 private:
  struct ReadName {
    int read = -1;  ///< number in FormulaInput::reads; negative: the position
    std::size_t component = 0;
    bool is_whole = false;
  };
  /// Whether the attribute is the assigned component alone.
  bool is_alone() const { return !moves_ && width_ == 1; }

  static std::vector<ReadName> sources_of(const formulas::PlainExpression& plain, const Expression& expression,
                                          const NamedValues& names, std::size_t first) {
    std::vector<ReadName> sources;
    for (const std::string& name : plain.names()) {
      const auto at = std::ranges::find(expression.names(), name, &Expression::Name::text) - expression.names().begin();
      const NamedValues::Source& source = names.sources()[static_cast<std::size_t>(at)];
      ReadName& read = sources.emplace_back();
      read.component = source.component;
      if (source.attribute < 0) continue;
      read.read = static_cast<int>(first) + source.attribute;
      const Type type = names.reads()[static_cast<std::size_t>(source.attribute)].type;
      read.is_whole = type == Type::i64 || type == Type::u64;
    }
    return sources;
  }

  static std::vector<formulas::PossibleNumber> values_of(const std::vector<ReadName>& sources, const FormulaInput& in) {
    std::vector<formulas::PossibleNumber> values;
    for (const ReadName& name : sources) {
      const Estimate e = name.read < 0 ? Estimate{.value = in.place.at, .error = in.place.error}
                                       : in.reads[static_cast<std::size_t>(name.read)];
      const Real v = name.component == 0 ? e.value.x : name.component == 1 ? e.value.y : e.value.z;
      Real low = v, high = v;
      if (e.error > 0) low = v - e.error, high = v + e.error;
      if (e.may_be_undefined) low = std::min<Real>(low, 0), high = std::max<Real>(high, 0);
      if (e.either_sign) low = std::min(low, -high), high = std::max(high, -low);
      if (e.is_open() || name.component > 2) low = -formulas::kInfinity, high = formulas::kInfinity;
      values.push_back({low, high, name.is_whole});
    }
    return values;
  }

  formulas::PlainExpression value_;
  std::vector<ReadName> value_sources_;
  std::optional<formulas::PlainExpression> condition_;
  std::vector<ReadName> condition_sources_;
  std::optional<std::size_t> old_;
  std::size_t component_, width_;
  bool moves_;
  formulas::Storage storage_;
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
  if (type == typeid(Normals)) return std::make_unique<NormalFormula>(static_cast<const Normals&>(op).options());
  if (type == typeid(Curvature)) return std::make_unique<CurvatureFormula>(contract);
  if (type == typeid(Splats))
    return std::make_unique<SplatFormula>(contract,
                                          static_cast<const Splats&>(op).options().axes == SplatAxes::curvature);
  if (type == typeid(Fair)) return std::make_unique<FairFormula>(contract, static_cast<const Fair&>(op).options());
  if (type == typeid(Features)) return std::make_unique<FeaturesFormula>(static_cast<const Features&>(op));
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
  if (type == typeid(Color)) return std::make_unique<ColorFormula>(static_cast<const Color&>(op));
  if (type == typeid(SetAttribute)) return std::make_unique<AssignmentFormula>(static_cast<const SetAttribute&>(op));
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
