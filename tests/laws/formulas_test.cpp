// SPDX-License-Identifier: MIT
/// `verify` has a formula for the stages of every operator of the registry. A formula shares no code with the operator.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/verify/values/cloud_formula.h"
#include "pointsweep/verify/values/kept_rows.h"
#include "pointsweep/verify/values/stage_formula.h"
#include "pointsweep/verify/verify.h"
#include "tests/formats/temporary_folder.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/support/every_operator.h"

namespace pointsweep {
namespace {

bool has_formula(const Operator& op) { return has_stage_formula(op) || has_cloud_formula(op) || has_kept_formula(op); }

TEST(EveryOperator, HasAFormulaOfItsOwn) {
  const TemporaryFolder folder;
  const std::filesystem::path other = folder.write("other.csv", "x,y,z,classification\n0,0,0,1\n1,1,1,2\n");
  Records input = with_attributes({{0, 0, 0}, {1, 2, 3}});
  const EveryOperator every({"classification", "intensity"}, "knn(radius=4)", other.string());
  std::size_t stages = 0;
  for (const OperatorDeclaration& declaration : all_operators()) {
    const OperatorCase one = every.case_of(declaration, every.values_of(declaration));
    SCOPED_TRACE(one.pipeline);
    InputCloud cloud = input.cloud();
    const ChainPlan plan = plan_chain(build_chain(parse_pipeline(one.pipeline), cloud), cloud.schema());
    for (const GraphNode& node : plan.graph.nodes) {
      if (node.op() == nullptr || node.is_order()) continue;
      ++stages;
      const Operator& op = *operator_of(*node.op());
      // The radius of simplify is an inner stage: `simplify` makes it, uses it and drops it.
      EXPECT_TRUE(has_formula(op) || op.name() == "simplify_radius") << op.name();
    }
  }
  EXPECT_GT(stages, all_operators().size());
}

}  // namespace
}  // namespace pointsweep
