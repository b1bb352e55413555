// SPDX-License-Identifier: MIT
/// Keeping one of several points that lie at one place.
#include <memory>
#include <optional>
#include <string>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"

namespace pointsweep {
namespace {

/// Keeps the first of the points at each place. Points at one place arrive one after another, the lowest row first.
class FirstOfEqual final : public InOrderWork {
 public:
  void add(unsigned, const OrderedPoints& points, Findings& findings) override {
    for (std::size_t i = 0; i < points.rows.size(); ++i) {
      if (last_ && points.places[i] == *last_) findings.dropped.push_back(points.rows[i]);
      last_ = points.places[i];
    }
  }

 private:
  std::optional<Vec3> last_;
};

/// Keeps one of the points with equal current coordinates: the one with the lowest row. -0 and 0 are equal; points
/// without a finite place are all kept. Needs no neighbourhoods: the points are put in order once.
class Unique final : public InOrderOperator {
 public:
  std::string name() const override { return "unique"; }
  InOrderContract in_order_contract() const override { return {.drops_rows = true, .arrival = "equal ones together"}; }
  std::unique_ptr<InOrderWork> start(const InOrderSetup&) const override { return std::make_unique<FirstOfEqual>(); }
  std::optional<Reach> reach() const override { return Reach{}; }
};

}  // namespace

OperatorDeclaration unique_declaration() {
  return {.name = "unique",
          .meaning = "keeps the first of points with equal coordinates; later stages see neighbours among those kept",
          .make = [](const OptionValues&, const Facts&) { return std::make_shared<Unique>(); },
          .undefined = "Points without a finite place are all kept.",
          .cost = "a pass that puts the points in order, without a search",
          .example = "unique"};
}

ChainStage operators::unique() { return std::make_shared<Unique>(); }

}  // namespace pointsweep
