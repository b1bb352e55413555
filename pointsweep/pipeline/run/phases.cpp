// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/run/phases.h"

namespace pointsweep {

std::vector<Phase> phases_of(const ChainPlan& plan) {
  std::vector<Phase> phases = {{PhaseKind::survey}};
  const std::size_t passes = plan.passes.size();
  for (std::size_t p = 0; p < passes; ++p) {
    if (plan.passes[p].kind != PassKind::rows) {
      phases.push_back({PhaseKind::order, p});
      phases.push_back({PhaseKind::sweep, p});
    }
    phases.push_back({plan.leaves_rows(p) ? PhaseKind::update : PhaseKind::write, p});
  }
  if (plan.reorders) phases.push_back({PhaseKind::order, passes});
  if (phases.back().kind != PhaseKind::write) phases.push_back({PhaseKind::write, passes});
  return phases;
}

}  // namespace pointsweep
