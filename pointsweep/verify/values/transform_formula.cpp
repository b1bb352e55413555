// SPDX-License-Identifier: MIT
#include <cmath>

#include "pointsweep/verify/formulas/affine.h"
#include "pointsweep/verify/values/stage_formula.h"

namespace pointsweep {
namespace {

using formulas::Affine;
using formulas::Estimate;
using formulas::Real;

Affine map_of(const NamedOptions& options) {
  const std::vector<double> none = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  const Vec3 t = options.has("translate") ? options.point("translate") : Vec3{};
  const Affine map(options.has("matrix") ? options.numbers("matrix") : none,
                   options.number_if_given("scale").value_or(1), {t.x, t.y, t.z});
  return options.has("inverse") && options.word("inverse") == "yes" ? map.inverse() : map;
}

/// Returns the power of the length in the unit of an attribute, e.g. -2 for "1/length^2".
int power_of(const std::string& unit) {
  if (unit.find("length") == unit.npos) return 0;
  const int size = unit.ends_with("^3") ? 3 : unit.ends_with("^2") ? 2 : 1;
  return unit.front() == '1' ? -size : size;
}

class TransformFormula final : public StageFormula {
 public:
  explicit TransformFormula(const FormulaSetup& stage) : map_(map_of(stage.options)), changed_(stage.contract.reads) {}
  std::vector<Estimate> evaluate(const FormulaInput& in) const override {
    const formulas::Place place = map_.moved(in.place);
    std::vector<Estimate> made = {{.value = place.at, .error = place.error}};
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

std::vector<NamedFormula> transform_formulas() { return {{"transform", formula_made<TransformFormula>}}; }

}  // namespace pointsweep
