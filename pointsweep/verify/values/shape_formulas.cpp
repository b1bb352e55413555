// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "pointsweep/verify/formulas/affine.h"
#include "pointsweep/verify/formulas/surface.h"
#include "pointsweep/verify/formulas/weighted_neighbors.h"
#include "pointsweep/verify/values/stage_formula.h"

namespace pointsweep {
namespace {

using formulas::Affine;
using formulas::Estimate;
using formulas::Real;

/// Returns the index of an attribute in a list; the size of the list if it does not hold the attribute.
std::size_t place_in(const std::vector<Attribute>& list, std::string_view name) {
  return static_cast<std::size_t>(std::ranges::find(list, name, &Attribute::name) - list.begin());
}

class NormalFormula {
 public:
  explicit NormalFormula(const FormulaSetup& stage) {
    const std::string& orient = stage.options.word("orient");
    if (orient == "up") facing_.side = Side::up;
    if (orient == "input") facing_.side = Side::like;
    if (orient != "viewpoint") return;
    const Vec3 viewpoint = stage.options.point("viewpoint");
    facing_.side = Side::viewpoint;
    facing_.viewpoint = {viewpoint.x, viewpoint.y, viewpoint.z};
  }
  Estimates operator()(const FormulaInput& in) const {
    formulas::Facing facing = facing_;
    if (facing.side == Side::like) facing.like = in.reads[0];
    return {formulas::normal(in.place, in.neighbors, facing)};
  }

 private:
  using Side = formulas::Facing::Side;
  formulas::Facing facing_;
};

StageFormula curvature_formula(const FormulaSetup& stage) {
  return [own = place_in(stage.contract.reads, "normal"),
          near = place_in(stage.contract.reads_neighbors, "normal")](const FormulaInput& in) {
    const formulas::Curvatures c = formulas::curvature(in.place, in.reads[own], in.neighbors, in.of_neighbors[near]);
    return Estimates{
        c.k1, c.k2, c.k1_direction, c.mean, c.gaussian, c.rms, c.absolute, c.surface_variation, c.normal_eigenvalues};
  };
}

StageFormula splat_formula(const FormulaSetup& stage) {
  const std::vector<Attribute>& reads = stage.contract.reads;
  const std::size_t direction = place_in(reads, "k1_direction");
  return [normal = place_in(reads, "normal"), k1 = place_in(reads, "k1"), k2 = place_in(reads, "k2"), direction,
          is_curved = direction < reads.size()](const FormulaInput& in) {
    formulas::CurvatureHere here;  // the axes come from the curvature if the stage reads it
    if (is_curved) here = {in.reads[k1], in.reads[k2], in.reads[direction]};
    const formulas::Splat s = formulas::splat(in.place, in.reads[normal], in.neighbors, is_curved ? &here : nullptr);
    return Estimates{s.axis, s.length, s.ratio};
  };
}

class FairFormula {
 public:
  explicit FairFormula(const FormulaSetup& stage)
      : f_(stage.options.number("f_length")),
        g_(stage.options.number("g_length")),
        own_length_(place_in(stage.contract.reads, "splat_length")),
        own_ratio_(place_in(stage.contract.reads, "splat_ratio")),
        normal_(place_in(stage.contract.reads_neighbors, "normal")),
        length_(place_in(stage.contract.reads_neighbors, "splat_length")),
        ratio_(place_in(stage.contract.reads_neighbors, "splat_ratio")) {}
  Estimates operator()(const FormulaInput& in) const {
    std::vector<formulas::Surfel> neighbors;
    for (std::size_t j = 0; j < in.neighbors.size(); ++j)
      neighbors.push_back(
          {in.neighbors[j], in.of_neighbors[normal_][j], in.of_neighbors[length_][j], in.of_neighbors[ratio_][j]});
    const formulas::Surfel own{in.place, {}, in.reads[own_length_], in.reads[own_ratio_]};
    return {formulas::faired(own, neighbors, f_, g_)};
  }

 private:
  double f_, g_;
  std::size_t own_length_, own_ratio_, normal_, length_, ratio_;
};

class FeaturesFormula {
 public:
  explicit FeaturesFormula(const FormulaSetup& stage) : with_point_(stage.options.word("with_point") == "yes") {
    for (const Attribute& a : stage.contract.makes) names_.push_back(a.name);
    const std::string& scale = stage.options.word("eigenvalues");
    lambda_ = scale == "raw" ? Lambda::raw : scale == "sqrt" ? Lambda::root : Lambda::normalized;
  }
  Estimates operator()(const FormulaInput& in) const {
    const formulas::Features f = formulas::features(in.place, in.neighbors, lambda_, with_point_);
    Estimates made;
    for (const std::string& name : names_) made.push_back(f.*std::ranges::find(kMembers, name, &Member::first)->second);
    return made;
  }

 private:
  using Lambda = formulas::Lambda;
  using Member = std::pair<std::string_view, Estimate formulas::Features::*>;
  static constexpr Member kMembers[] = {{"linearity", &formulas::Features::linearity},
                                        {"planarity", &formulas::Features::planarity},
                                        {"sphericity", &formulas::Features::sphericity},
                                        {"omnivariance", &formulas::Features::omnivariance},
                                        {"anisotropy", &formulas::Features::anisotropy},
                                        {"eigenentropy", &formulas::Features::eigenentropy},
                                        {"eigenvalue_sum", &formulas::Features::eigenvalue_sum},
                                        {"surface_variation", &formulas::Features::surface_variation},
                                        {"verticality", &formulas::Features::verticality},
                                        {"moment1_axis1", &formulas::Features::moment1_axis1},
                                        {"moment1_axis2", &formulas::Features::moment1_axis2},
                                        {"moment2_axis1", &formulas::Features::moment2_axis1},
                                        {"moment2_axis2", &formulas::Features::moment2_axis2},
                                        {"height_range", &formulas::Features::height_range},
                                        {"number_of_neighbors", &formulas::Features::number_of_neighbors}};
  std::vector<std::string> names_;
  bool with_point_;
  Lambda lambda_;
};

/// Returns the formula of TurnedNormals, the last stage of orient().
StageFormula turned_formula(const FormulaSetup&) {
  return [](const FormulaInput& in) {
    Estimate normal = in.reads[0];
    if (in.reads[1].is_open())
      normal.either_sign = true;
    else if (in.reads[1].value.x != 0)
      normal.value = formulas::Vector{} - normal.value;  // 0 for 0 and for -0
    return Estimates{normal};
  };
}

Affine map_of(const NamedOptions& options) {
  const std::vector<double> none = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  const Vec3 t = options.has("translate") ? options.point("translate") : Vec3{};
  const Affine map(options.has("matrix") ? options.numbers("matrix") : none,
                   options.number_if_given("scale").value_or(1), {t.x, t.y, t.z});
  return options.has("inverse") && options.word("inverse") == "yes" ? map.inverse() : map;
}

/// Returns the power of the length in the unit of an attribute, e.g. -2 for "1/length^2"; 0 without a length.
int power_of(const std::string& unit) {
  if (unit.find("length") == unit.npos) return 0;
  const int size = unit.ends_with("^3") ? 3 : unit.ends_with("^2") ? 2 : 1;
  return unit.front() == '1' ? -size : size;
}

class TransformFormula {
 public:
  explicit TransformFormula(const FormulaSetup& stage) : map_(map_of(stage.options)), changed_(stage.contract.reads) {}
  Estimates operator()(const FormulaInput& in) const {
    const formulas::Place place = map_.moved(in.place);
    Estimates made = {{.value = place.at, .error = place.error}};
    for (std::size_t a = 0; a < changed_.size(); ++a)
      for (std::size_t e = 0; e < estimates_of(changed_[a]); ++e)
        made.push_back(estimates_of(changed_[a]) > 1 ? formulas::open() : changed(changed_[a], in.reads[a]));
    return made;
  }

 private:
  Estimate changed(const Attribute& a, const Estimate& before) const {
    Estimate after = before;
    if (a.kind == Kind::normal) after = map_.normal(before);
    if (a.kind == Kind::vector) after = map_.tangent(before);
    const int power = power_of(a.unit);
    if (power == 0 || map_.scale() == 1) return after;
    const Real factor = std::pow(map_.scale(), static_cast<Real>(power));
    const Real rounding = a.type == Type::f32 ? formulas::kSingle : 16 * formulas::kDouble;
    after.value = factor * after.value;
    after.error = factor * after.error + 2 * rounding * formulas::norm(after.value);
    return after;
  }

  Affine map_;
  std::vector<Attribute> changed_;
};

}  // namespace

std::vector<NamedFormula> shape_formulas() {
  return {{"normals", formula_made<NormalFormula>},
          {"curvature", curvature_formula},
          {"splats", splat_formula},
          {"fair", formula_made<FairFormula>},
          {"features", formula_made<FeaturesFormula>},
          {"turned_normals", turned_formula},
          {"transform", formula_made<TransformFormula>}};
}

}  // namespace pointsweep
