// SPDX-License-Identifier: MIT
#include <cstdint>
#include <optional>
#include <vector>

#include "pointsweep/verify/formulas/levels.h"
#include "pointsweep/verify/values/cloud_formula.h"

namespace pointsweep {
namespace {

formulas::Estimate level_is(std::uint8_t level) { return {.value = {static_cast<formulas::Real>(level), 0, 0}}; }

class LevelFormula final : public CloudFormula {
 public:
  explicit LevelFormula(const FormulaSetup&) {}

  void prepare(const CloudInput& in) override {
    require_memory(in.rows.count() * formulas::kLevelBytes, in.rows);
    std::vector<formulas::Coordinates> points;
    in.rows.for_each({}, [&](std::uint64_t row, Vec3 p, std::span<const double>) {
      number_.resize(row + 1);
      number_[row] = points.size();
      if (is_finite(p)) points.push_back({p.x, p.y, p.z});
    });
    levels_ = formulas::levels_of(points);
  }

  std::vector<std::vector<formulas::Estimate>> evaluate(std::span<const CloudPoint> points,
                                                        const CloudInput&) override {
    std::vector<std::vector<formulas::Estimate>> made;
    for (const CloudPoint& p : points) made.push_back({level_is(levels_[number_[p.at.row]])});
    return made;
  }
  std::optional<std::vector<formulas::Estimate>> unplaced(const CloudPoint&) const override {
    return {{level_is(255)}};
  }

 private:
  std::vector<std::size_t> number_;  ///< for each row, its number among the points with finite coordinates
  std::vector<std::uint8_t> levels_;
};

}  // namespace

NamedCloudFormula level_formula() { return {"level", cloud_formula_made<LevelFormula>}; }

}  // namespace pointsweep
