// SPDX-License-Identifier: MIT
/// A description of a sort(), made without running it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/memory_plan.h"

namespace pointsweep {

struct SortPreview {
  std::uint64_t points = 0;
  std::uint64_t budget = 0;  ///< bytes
  int axis = 0;
  std::uint32_t record_bytes = 0, output_bytes = 0;  ///< of a point: of the input, of the output before its format
  std::uint64_t decoded_bytes = 0;                   ///< decoded_input_bytes()
  MemoryPlan memory;
  std::string note;  ///< where fewer threads work than were asked for
};

/// Looks at a sample of the cloud and writes nothing. Throws what sort() to `output` would throw before the work.
SortPreview preview_sort(InputCloud& cloud, const std::filesystem::path& output, const EngineOptions& options,
                         const std::vector<std::string>& keep = {});

/// Several lines: points, order, slabs, records, memory.
std::string to_text(const SortPreview& preview);

}  // namespace pointsweep
