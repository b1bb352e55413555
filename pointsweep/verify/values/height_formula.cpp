// SPDX-License-Identifier: MIT
#include <array>

#include "pointsweep/verify/formulas/interpolation.h"
#include "pointsweep/verify/search/nearest_in_stream.h"
#include "pointsweep/verify/values/cloud_formula.h"

namespace pointsweep {
namespace {

constexpr double kClassBelow = 2;

class HeightFormula final : public CloudFormula {
 public:
  explicit HeightFormula(const FormulaSetup& stage) : k_(static_cast<std::size_t>(stage.options.whole("k"))) {}
  void prepare(const CloudInput& in) override { in.rows.require(std::array{in.source(0)}); }
  std::vector<std::vector<formulas::Estimate>> evaluate(std::span<const CloudPoint> points,
                                                        const CloudInput& in) override {
    const std::array classes = {in.source(0)};
    const PointsOfCloud ground = [&](const auto& take) {
      in.rows.for_each(classes, [&](std::uint64_t row, Vec3 p, std::span<const double> values) {
        if (values[0] == kClassBelow) take(row, p);
      });
    };
    std::vector<Vec3> places;
    for (const CloudPoint& p : points) places.push_back(p.at.position);
    const auto nearest =
        nearest_of_cloud(places, ground, in.rows.count(), {.most = k_, .space = NearestInStream::Space::plane});
    std::vector<std::vector<formulas::Estimate>> made;
    std::vector<formulas::GroundPoint> below;
    for (std::size_t i = 0; i < points.size(); ++i) {
      below.clear();
      for (const NearPoint& g : nearest[i]) below.push_back({g.distance2, g.position.z});
      made.push_back({formulas::height_above(places[i].z, below)});
    }
    return made;
  }

 private:
  std::size_t k_;
};

}  // namespace

NamedCloudFormula height_formula() { return {"height", cloud_formula_made<HeightFormula>}; }

}  // namespace pointsweep
