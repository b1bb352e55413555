// SPDX-License-Identifier: MIT
/// What a run would do, known without doing it.
#pragma once

#include <cstdint>
#include <string>

#include "pointsweep/pipeline/memory_plan.h"
#include "pointsweep/pipeline/pipeline.h"

namespace pointsweep {

/// A column of the window: one version of an attribute.
struct ColumnPlan {
  std::string attribute;
  std::string made_by;  ///< "the file", or the stage as "2 normals"
  std::uint32_t bytes = 0;
  std::size_t last_step = 0;  ///< the step after which nobody reads it any more; a kept one is written after the last
  bool written = false;
};

struct Preview {
  PlannedChain planned;
  std::vector<ColumnPlan> columns;  ///< by column number
  std::uint64_t points = 0;
  std::uint64_t record_bytes = 0;  ///< of a point on its way through the stream
  std::uint64_t budget = 0;
  MemoryPlan memory;
};

/// Looks at a sample of the cloud and writes nothing. Throws what run() would throw before the work.
Preview preview(Cloud& cloud, const Chain& chain, const RunOptions& options = {});

/// The stages with their steps and buffers, the columns, the record of results, slabs and memory, as a text of lines.
std::string to_text(const Preview& preview);

}  // namespace pointsweep
