// SPDX-License-Identifier: MIT
/// Exact order for neighbours that single precision found but could not tell apart.
#pragma once

#include <cstdint>

#include "pointsweep/search/best_list.h"
#include "pointsweep/search/directory.h"

namespace pointsweep {

/// A point of some cell, seen from p.
inline Candidate candidate_from(const CellDirectory& directory, NeighborRef ref, Vec3 p) {
  const Cell& cell = directory.cell(slot_of(ref));
  const Vec3 at = cell.position(index_of(ref));
  return {distance2(at, p), at, cell.row[index_of(ref)], ref};
}

/// Puts runs of a list of at most 64 neighbours of p into exact order: bit i of `close_to_next` says that places i and
/// i + 1 belong to one run.
void order_runs(const CellDirectory& directory, Vec3 p, std::uint64_t close_to_next, NeighborRef* refs);

}  // namespace pointsweep
