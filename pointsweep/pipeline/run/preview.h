// SPDX-License-Identifier: MIT
/// A description of a run, made without running it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/memory/run_memory.h"
#include "pointsweep/pipeline/memory_plan.h"
#include "pointsweep/pipeline/output/output_formats.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

struct Preview {
  ChainPlan planned;
  OutputNames names;
  std::string system_warning;  ///< kept_system_warning()
  std::uint64_t points = 0;
  std::vector<std::string> others;  ///< for each pass, the other cloud that it reads, or nothing
  std::vector<std::string> notes;   ///< about the request, one sentence each
  std::size_t tiles = 0;            ///< outputs, one for each input; 0: one output of all
  bool is_divided = false;          ///< RunOptions::division
  std::optional<int> axis;          ///< that was asked for
  std::uint64_t budget = 0;
  std::uint64_t decoded_bytes = 0;  ///< decoded_input_bytes()
  std::uint64_t aside_bytes = 0;    ///< of all points, see pointsweep::aside_bytes()
  RunMemory memory;
};

/// Looks at a sample of the cloud and writes nothing. Throws what run() would throw before the work.
/// `outputs`: the files to write, as far as their formats decide names and how large a record is; they need not exist.
Preview preview(InputCloud& cloud, const Chain& chain, const EngineOptions& options = {}, const Outputs& outputs = {});

/// Pass by pass the stages with their steps and buffers, the columns, what is carried on and the slabs; then the
/// record of results and memory, as a text of lines.
std::string to_text(const Preview& preview);

/// A description of a sort(), made without running it.
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
