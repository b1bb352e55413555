// SPDX-License-Identifier: MIT
/// The memory of all phases of a run, and the memory of its inputs and outputs. See memory_plan.h for the parts of a
/// plan, such as window and recall.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/memory_plan.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/pipeline/rows/input_source.h"

namespace pointsweep {

/// The estimated effort of a pass whose time does not follow from the number of points: a pass with a radius without a
/// limit k, or with an in-order operator. 0 seconds for all other passes.
struct Effort {
  double seconds = 0;  ///< wall time on all threads
  std::string cause;   ///< cause of the effort, for a sentence: "The radius"
  std::string text;    ///< measure of the cause: "about 400 neighbours per point"
  std::string remedy;  ///< advice to the user: "a smaller one takes less"
};

/// Wall time in seconds from which the effort of a run is reported to the user before the work.
inline constexpr double kLongSeconds = 60;

/// The memory of all phases, planned before the first phase.
struct RunMemory {
  std::vector<MemoryPlan> passes;  ///< memory plan of each pass
  std::size_t ordered_pass = 0;    ///< number of the first pass that puts points in order: first_ordered_pass()
  /// The plan for `ordered_pass` in which a distribution pass puts the points into slabs (docs/adr/0004). Set if slabs
  /// are to be made on demand (docs/adr/0011); used if that turns out to be impossible.
  std::optional<MemoryPlan> by_distribution;
  std::string order_text;  ///< for a sentence: how `ordered_pass` puts its points in order, and why
  /// For each pass, bytes of a point's record in the stream; for a pass over rows, bytes of a row as the pass sees it.
  std::vector<std::uint64_t> record_bytes;
  std::vector<Effort> efforts;       ///< effort of each pass
  MemoryPlan reordering;             ///< plan for putting the output in order, if ChainPlan::reorders
  bool spill_rows = false;           ///< true if records carried between passes, and masks of rows, are spilled
  std::uint64_t row_bytes = 0;       ///< most bytes of carried records and masks, in memory or in the temporary folder
  std::uint64_t expected_bytes = 0;  ///< greatest expected memory of the run at any time
  std::uint64_t needed_bytes = 0;    ///< least sufficient budget if the given one is too small; otherwise 0
  unsigned threads = 1;              ///< threads that work after the survey
  std::string threads_note;          ///< sentence for the user if fewer threads work than requested; otherwise empty
  bool spills() const;
};

/// A function that returns the bytes of open inputs, decoders and encoders for a number of threads.
using CodecBytes = std::function<std::uint64_t(unsigned threads)>;

/// Plans the memory of all passes. Records carried between passes stay in memory only if nothing else is spilled and
/// they fit. One survey serves all sweeps, since the places of moved points are not known yet. The number of threads is
/// limited by the options and by the budget; with a limit k, threads beyond the second work only if the memory of all
/// threads is at most a quarter of the budget beyond kFixedBytes, so that enough is left for the window and the recall.
/// Throws Error, which states the least sufficient budget, if the budget is too small for one thread. `output_bytes`:
/// bytes of an output record; `codecs` may be empty.
RunMemory plan_run_memory(std::uint64_t budget, const ChainPlan& planned, std::uint64_t points, const Survey& survey,
                          const EngineOptions& options, std::uint64_t output_bytes, const CodecBytes& codecs = {},
                          const OnDemandOrder& on_demand = {"it was not looked for", {}});

/// Returns the bytes of the open inputs beyond the allowance in kFixedBytes: some kB for each file after the first
/// hundred, and the memory for requests if an input is a URL. Must be called before inputs are decoded
/// (decoded_input()).
std::uint64_t open_input_bytes(const InputCloud& cloud);
/// Throws Error if `open_bytes`, the result of open_input_bytes(), and kFixedBytes together exceed the budget.
void require_room_for_inputs(std::uint64_t budget, std::uint64_t open_bytes, const InputCloud& cloud);

/// Returns the number of threads that the options request; without a request, the number of hardware threads.
unsigned threads_asked_for(const EngineOptions& options);

/// Returns the number of threads that work until the memory of the passes is planned: the requested number, or fewer if
/// the budget requires it.
unsigned survey_threads(const InputCloud& cloud, const EngineOptions& options);

/// Returns the sum of three sizes: the bytes that decoding the inputs for which FileInfo::decode_once is false takes on
/// `threads` threads; the bytes that encoding records of `record_bytes` to these outputs takes; and, if the output is
/// divided among files, the least memory for dividing it.
std::uint64_t codec_bytes(const InputCloud& cloud, const Outputs& outputs, const RunOptions& options,
                          std::uint64_t record_bytes, unsigned threads);

/// Returns the bytes that decoding the inputs for which FileInfo::decode_once is true takes on `threads` threads, in a
/// run that reads their rows once.
std::uint64_t once_decoder_bytes(const InputCloud& cloud, unsigned threads);

/// Returns the most bytes that encoding records of `record_bytes` to one of the outputs takes.
std::uint64_t encoder_bytes(const Outputs& outputs, std::uint64_t record_bytes, unsigned threads);

/// Returns the most bytes that one output stores in the temporary folder (OutputPlan::scratch) for `count` records of
/// `record_bytes`, if encoders may use `memory` bytes.
std::uint64_t aside_bytes(const Outputs& outputs, std::uint64_t count, std::uint64_t record_bytes, std::uint64_t memory,
                          unsigned threads);

/// Returns whether the last pass takes points in the order of the output, so that its stream holds whole records.
bool leaves_in_order(const ChainPlan& planned, const EngineOptions& options);

}  // namespace pointsweep
