// SPDX-License-Identifier: MIT
/// Exact neighbourhoods of any points of the cloud by reading the ordered stream again, slab by slab.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pointsweep/search/best_list.h"
#include "pointsweep/sweep/slab_loader.h"

namespace pointsweep {

/// A point and its neighbourhood, each with the bytes of its file columns.
struct StreamQuery {
  Vec3 position;
  std::uint64_t row = 0;
  double reach2 = Box::kInf;  ///< in: its neighbourhood ends within it, if known
  std::uint32_t slab = 0;     ///< out, as its place there
  std::uint32_t index_in_slab = 0;
  std::string file_columns;                   ///< out: in the order of the plan
  std::vector<Candidate> neighbors;           ///< out: nearest first
  std::vector<std::string> neighbor_columns;  ///< out: beside `neighbors`; empty if the plan has no file columns
};

/// Fills in the queries. Reads every slab that a ball touches once, or twice where a query came without a reach.
/// Returns the number of slabs read.
std::uint64_t search_stream(const Stream& stream, const SweepPlan& plan, const SlabLoader& loader,
                            std::vector<StreamQuery>& queries);

}  // namespace pointsweep
