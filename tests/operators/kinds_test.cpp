// SPDX-License-Identifier: MIT
/// The kinds of stages: what their classes derive from, and that a visit needs a case for each kind.
#include <gtest/gtest.h>

#include <memory>
#include <type_traits>
#include <variant>

#include "pointsweep/operators.h"
#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/overloaded.h"

namespace pointsweep {
namespace {

template <class Kind>
bool is(const ChainStage& stage) {
  return std::holds_alternative<std::shared_ptr<const Kind>>(stage);
}

TEST(Kinds, AnOperatorIsOfTheKindFromWhichItsClassDerives) {
  EXPECT_TRUE(is<LocalOperator>(operators::normals()));
  EXPECT_TRUE(is<SelectOperator>(operators::where("x > 0")));
  EXPECT_TRUE(is<InOrderOperator>(operators::unique()));
  EXPECT_TRUE(is<InOrderOperator>(operators::voxel({1, VoxelKeep::centroid})));
  EXPECT_TRUE(is<InOrderOperator>(operators::ground()));
  EXPECT_TRUE(is<ConnectOperator>(operators::components()));
  EXPECT_TRUE(is<CompositeOperator>(operators::sor()));
  EXPECT_TRUE(std::holds_alternative<Drop>(operators::drop({"intensity"})));
}

TEST(Kinds, TellWhichStagesDropRows) {
  for (const ChainStage& stage :
       {operators::where("x > 0"), operators::unique(), operators::poisson({.radius = 1}),
        operators::voxel({1, VoxelKeep::centroid}), operators::simplify({.error = 0.1, .most = 1})})
    EXPECT_TRUE(drops_rows(stage)) << name_of(stage);
  for (const ChainStage& stage : {operators::normals(), operators::ground(), operators::components(), operators::sor(),
                                  operators::drop({"intensity"}), ChainStage(Reneighbor()), ChainStage(Resort())})
    EXPECT_FALSE(drops_rows(stage)) << name_of(stage);
}

TEST(Kinds, OfNoKindIsNoStage) {
  class OfNoKind final : public Operator {
    std::string name() const override { return "of_no_kind"; }
    Contract contract() const override { return {}; }
  };
  static_assert(!std::is_constructible_v<ChainStage, std::shared_ptr<OfNoKind>>);
  static_assert(!std::is_constructible_v<ChainStage, std::shared_ptr<const Operator>>);
}

TEST(Kinds, AVisitorWithoutACaseForAKindDoesNotTakeIt) {
  const auto visitor = overloaded{[](const std::shared_ptr<const LocalOperator>&) {}, [](const Drop&) {}};
  using Visitor = decltype(visitor);
  static_assert(std::is_invocable_v<Visitor, const Drop&>);
  static_assert(std::is_invocable_v<Visitor, const std::shared_ptr<const LocalOperator>&>);
  static_assert(!std::is_invocable_v<Visitor, const std::shared_ptr<const SelectOperator>&>);
  static_assert(!std::is_invocable_v<Visitor, const Resort&>);
}

}  // namespace
}  // namespace pointsweep
