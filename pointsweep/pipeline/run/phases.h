// SPDX-License-Identifier: MIT
/// A run is a list of phases. Each takes what the one before has left in the RunState; checkpoints stand between them
/// (run_checkpoints.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pointsweep/pipeline/run/run_state.h"

namespace pointsweep {

enum class PhaseKind : std::uint8_t {
  survey,  ///< looks at the input, plans the memory and opens the outputs
  order,   ///< puts the points in order: RunState::stream
  sweep,   ///< goes through them, which makes RunState::results
  update,  ///< makes of the results the rows and values that the next pass begins with
  write,   ///< makes of the results, or of the rows, the output
};

struct Phase {
  PhaseKind kind;
  /// For which pass; the number of passes for the output that is put in order, or written, after the last one.
  std::size_t pass = 0;
  friend bool operator==(const Phase&, const Phase&) = default;
};

/// Returns the phases of a run. A plan without passes only puts the input in order.
std::vector<Phase> phases_of(const ChainPlan& plan);

/// Surveys the input and plans the memory.
void survey_phase(RunState& run);
/// Opens the outputs. On the threads that RunMemory::threads allows, as all that follows.
void open_run(RunState& run);
void order_phase(RunState& run, std::size_t pass);
void sweep_phase(RunState& run, std::size_t pass);
void update_phase(RunState& run, std::size_t pass);
void write_phase(RunState& run, std::size_t pass);

}  // namespace pointsweep
