// SPDX-License-Identifier: MIT
/// Certificates of the cells of a window: which neighbourhoods are proven complete, and which points are left to the
/// recall.
#pragma once

#include <cstdint>

#include "pointsweep/sweep/frontier.h"
#include "pointsweep/sweep/window.h"
#include "pointsweep/sweep/worker.h"

namespace pointsweep {

/// Certifies the points of a cell. The ball of a point has the squared radius worker.reach2 and must touch no unread
/// slab and no dropped cell; otherwise the point is deferred. A point whose ball touches only a box outside of the
/// stream is unresolved. Returns false if so many balls touch an unread slab that the cell is to wait and be searched
/// again.
bool certify(WindowCell& cell, const Frontier& frontier, Worker& worker);

/// Defers the points of the cell, from `first` on, whose lists name a point that was deferred before this step: what it
/// could not give in time they cannot use.
void defer_dependents(const Neighborhood& what, WindowCell& cell, std::uint32_t first, const CellNeighbors& lists,
                      const Window& window);

}  // namespace pointsweep
