// SPDX-License-Identifier: MIT
/// The method of the paper, point by point, as an engine of runs: a baseline for the speed of the exact engine, and an
/// independent check of its results.
///
/// R. Pajarola, "Stream-Processing Points", IEEE Visualization 2005. The reference shares with the exact engine
/// attributes, file formats, the ordered stream (given in Section 3) and the formulas of the operators; search, buffers
/// and the sweep are its own. One thread; O(k n log m) for m active points. Memory holds the active set, whose size
/// depends on the cloud: points leave it in the order of the stream, so each point waits for the slowest point before
/// it.
#pragma once

namespace pointsweep {

/// Lets the runs of this program use Engine::reference.
void register_reference_engine();

}  // namespace pointsweep
