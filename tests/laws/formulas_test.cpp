// SPDX-License-Identifier: MIT
/// `verify` checks the stages of every operator of the registry by a formula that shares no code with the operator, or
/// refuses the chain.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/verify/checked_stages.h"
#include "pointsweep/verify/values/cloud_formula.h"
#include "pointsweep/verify/values/kept_rows.h"
#include "pointsweep/verify/values/stage_formula.h"
#include "tests/formats/temporary_folder.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/support/every_operator.h"

namespace pointsweep {
namespace {

bool has_formula(const Operator& op) { return has_stage_formula(op) || has_cloud_formula(op) || has_kept_formula(op); }

/// Returns whether verify() refuses the chain.
bool is_refused(const ChainPlan& plan, const InputCloud& cloud) {
  try {
    rows_kept_first({}, cloud, plan.graph);
    return false;
  } catch (const UsageError&) {
    return true;
  }
}

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
      EXPECT_TRUE(has_formula(op) || is_refused(plan, cloud)) << op.name();
    }
  }
  EXPECT_GT(stages, all_operators().size());
}

}  // namespace
}  // namespace pointsweep
