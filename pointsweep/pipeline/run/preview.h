// SPDX-License-Identifier: MIT
/// A description of a run, made without running it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/memory/run_memory.h"
#include "pointsweep/pipeline/output/output_formats.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

struct Preview {
  ChainPlan planned;
  OutputNames names;
  std::string system_warning;  ///< result of kept_system_warning(): a sentence, or empty
  std::uint64_t points = 0;
  std::vector<std::string> others;  ///< for each pass, name and number of points of the other cloud; empty if none
  std::vector<std::string> notes;   ///< sentences about the request
  std::size_t tiles = 0;            ///< number of tiles, one for each input; 0 if one output holds all points
  bool is_divided = false;          ///< true if RunOptions::division divides the output among files
  std::optional<int> axis;          ///< axis that the user has stated, if any
  std::uint64_t budget = 0;         ///< memory budget in bytes
  std::uint64_t decoded_bytes = 0;  ///< result of decoded_input_bytes()
  std::uint64_t aside_bytes = 0;    ///< result of bytes_aside() (request.h)
  RunMemory memory;
};

/// Plans a run from a sample of the cloud, without writing. Throws most errors that run() throws before the work, and
/// UsageError for the reference engine. `outputs`: their formats decide names and the size of records; the files need
/// not exist.
Preview preview(const InputCloud& cloud, const Chain& chain, const EngineOptions& options = {},
                const Outputs& outputs = {});

/// Returns lines of text about the number of points, each pass (stages, steps, buffers, columns, carried attributes,
/// slabs), the record of results, the outputs and the memory, and the notes.
std::string to_text(const Preview& preview);

}  // namespace pointsweep
