// SPDX-License-Identifier: MIT
#include <cmath>
#include <limits>

#include "pointsweep/verify/formulas/cylinder.h"
#include "pointsweep/verify/search/ball_index.h"
#include "pointsweep/verify/search/nearest_in_stream.h"
#include "pointsweep/verify/values/cloud_formula.h"

namespace pointsweep {
namespace {

using formulas::Estimate;
using Estimates = std::vector<Estimate>;

/// Opens another cloud without a transformation of coordinates: the run has refused different reference systems.
std::unique_ptr<InputCloud> opened(const std::string& name) { return opened_cloud(name, true); }

PointsOfCloud points_of(RowSource& source, const PhaseProgress& progress) {
  return [&](const auto& take) { for_each_position(source, "comparing", progress, take); };
}

class NearestDistance final : public CloudFormula {
 public:
  explicit NearestDistance(const FormulaSetup& stage)
      : other_(opened(stage.options.word("cloud"))),
        most_(stage.options.number_if_given("most").value_or(std::numeric_limits<double>::infinity())) {}
  void prepare(const CloudInput&) override {}
  std::vector<Estimates> evaluate(std::span<const CloudPoint> points, const CloudInput& in) override {
    std::vector<Vec3> places;
    for (const CloudPoint& p : points) places.push_back(p.at.position);
    RowSource source(*other_);
    const auto nearest =
        nearest_of_cloud(places, points_of(source, in.rows.progress()), source.count(), {.reach2 = most_ * most_});
    std::vector<Estimates> made;
    for (const auto& found : nearest)
      made.push_back({{.value = {found.empty() ? std::numeric_limits<formulas::Real>::quiet_NaN()
                                               : std::sqrt(found.front().distance2),
                                 0, 0}}});
    return made;
  }

 private:
  std::unique_ptr<InputCloud> other_;
  double most_;
};

class ChangeAlongNormals final : public CloudFormula {
 public:
  explicit ChangeAlongNormals(const FormulaSetup& stage)
      : other_(opened(stage.options.word("cloud"))),
        cylinder_(stage.options.number("cylinder")),
        depth_(stage.options.number("depth")),
        registration_(stage.options.number("registration")) {}
  void prepare(const CloudInput&) override {}
  std::vector<Estimates> evaluate(std::span<const CloudPoint> points, const CloudInput& in) override {
    RowSource other(*other_);
    const auto before = filled(points, in.rows.input(), in.rows.progress());
    const auto after = filled(points, other, in.rows.progress());
    std::vector<Estimates> made;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto c = formulas::change(before[i], after[i], registration_, points[i].reads[0].either_sign);
      made.push_back({c.distance, c.level, c.spread1, c.spread2, c.samples1, c.samples2});
    }
    return made;
  }

 private:
  std::vector<formulas::Cylinder> filled(std::span<const CloudPoint> points, RowSource& cloud,
                                         const PhaseProgress& progress) const {
    std::vector<formulas::Cylinder> cylinders;
    std::vector<Vec3> centers;
    std::vector<double> reach2;
    for (const CloudPoint& p : points) {
      const Vec3 c = p.at.position;
      cylinders.emplace_back(formulas::Vector{c.x, c.y, c.z}, p.reads[0], cylinder_, depth_);
      centers.push_back(c);
      reach2.push_back(static_cast<double>(cylinders.back().reach2()));
    }
    const BallIndex balls(centers, reach2);
    for_each_position(cloud, "comparing", progress, [&](std::uint64_t, Vec3 p) {
      if (!is_finite(p)) return;
      balls.visit(p, [&](std::uint32_t i) {
        if (distance2(centers[i], p) <= reach2[i]) cylinders[i].add({p.x, p.y, p.z});
      });
    });
    return cylinders;
  }

  std::unique_ptr<InputCloud> other_;
  double cylinder_, depth_, registration_;
};

}  // namespace

std::vector<NamedCloudFormula> change_formulas() {
  return {{"distance_to", cloud_formula_made<NearestDistance>}, {"m3c2", cloud_formula_made<ChangeAlongNormals>}};
}

}  // namespace pointsweep
