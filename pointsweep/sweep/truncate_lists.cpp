// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/truncate_lists.h"

#include <algorithm>

namespace pointsweep {

void truncate_lists(const SweepPlan& plan, const PointColumns& own, std::size_t size, const PointColumns* slots,
                    CellNeighbors& lists) {
  if (!plan.neighborhood.rule) return;
  std::vector<std::uint32_t> counts(size);
  plan.neighborhood.rule->choose(
      Neighborhoods(own, size, slots, lists.begin.data(), lists.refs.data(), plan.rule_reads, {}), counts);
  std::uint32_t end = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::uint32_t from = lists.begin[i], kept = std::min(counts[i], lists.begin[i + 1] - from);
    const auto first = lists.refs.begin() + from;
    std::copy(first, first + kept, lists.refs.begin() + end);
    lists.begin[i] = end;
    end += kept;
  }
  lists.begin[size] = end;
  lists.refs.resize(end);
}

}  // namespace pointsweep
