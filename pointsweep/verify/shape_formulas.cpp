// SPDX-License-Identifier: MIT
#include "pointsweep/verify/shape_formulas.h"

#include <algorithm>
#include <typeinfo>

#include "pointsweep/operators/curvature.h"
#include "pointsweep/operators/fair.h"
#include "pointsweep/operators/features.h"
#include "pointsweep/operators/normals.h"
#include "pointsweep/operators/orient.h"
#include "pointsweep/operators/splats.h"
#include "pointsweep/verify/formulas/curvature.h"
#include "pointsweep/verify/formulas/fairing.h"
#include "pointsweep/verify/formulas/features.h"
#include "pointsweep/verify/formulas/normal.h"
#include "pointsweep/verify/formulas/splat.h"

namespace pointsweep {
namespace {

using formulas::Estimate;
using ShapeEstimates = std::vector<Estimate>;

/// Place of an attribute in a list of a contract that has it.
std::size_t place_in(const std::vector<Attribute>& list, const Attribute& wanted) {
  const auto is_wanted = [&](const Attribute& a) { return a.name == wanted.name; };
  return static_cast<std::size_t>(std::find_if(list.begin(), list.end(), is_wanted) - list.begin());
}

class NormalFormula final : public StageFormula {
 public:
  explicit NormalFormula(const NormalsOptions& options) : options_(options) {}
  ShapeEstimates evaluate(const FormulaInput& in) const override {
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
  ShapeEstimates evaluate(const FormulaInput& in) const override {
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
  ShapeEstimates evaluate(const FormulaInput& in) const override {
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
  ShapeEstimates evaluate(const FormulaInput& in) const override {
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
  ShapeEstimates evaluate(const FormulaInput& in) const override {
    const formulas::Features f = formulas::features(in.place, in.neighbors, lambda_, with_point_);
    const Estimate all[kFeatures] = {f.linearity,     f.planarity,     f.sphericity,         f.omnivariance,
                                     f.anisotropy,    f.eigenentropy,  f.eigenvalue_sum,     f.surface_variation,
                                     f.verticality,   f.moment1_axis1, f.moment1_axis2,      f.moment2_axis1,
                                     f.moment2_axis2, f.height_range,  f.number_of_neighbors};
    ShapeEstimates made;
    for (const Feature feature : made_) made.push_back(all[static_cast<std::size_t>(feature)]);
    return made;
  }

 private:
  std::vector<Feature> made_;
  bool with_point_;
  formulas::Lambda lambda_;
};

/// What orient() makes of a normal.
class TurnedFormula final : public StageFormula {
 public:
  ShapeEstimates evaluate(const FormulaInput& in) const override {
    Estimate normal = in.reads[0];
    if (in.reads[1].is_open())
      normal.either_sign = true;
    else if (in.reads[1].value.x != 0)
      normal.value = formulas::Vector{} - normal.value;  // 0 for 0 and for -0
    return {normal};
  }
};

}  // namespace

std::unique_ptr<StageFormula> shape_formula_of(const Operator& op) {
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
  if (type == typeid(TurnedNormals)) return std::make_unique<TurnedFormula>();
  return nullptr;
}

}  // namespace pointsweep
