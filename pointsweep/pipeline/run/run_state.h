// SPDX-License-Identifier: MIT
/// The state that the phases of a run share: the request, the plan, the results of a phase for a later phase, and the
/// counts.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "pointsweep/order/row_file.h"
#include "pointsweep/order/row_store.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/order/temp_folder.h"
#include "pointsweep/pipeline/checkpoint/checkpoints.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/memory/run_memory.h"
#include "pointsweep/pipeline/output/output_names.h"
#include "pointsweep/pipeline/output/output_set.h"
#include "pointsweep/pipeline/output/tile_set.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/pipeline/plan/output_layout.h"
#include "pointsweep/pipeline/rows/decoded_input.h"
#include "pointsweep/pipeline/rows/finite_input.h"
#include "pointsweep/pipeline/rows/ordered_output.h"
#include "pointsweep/pipeline/rows/other_cloud.h"
#include "pointsweep/pipeline/rows/pass_values.h"
#include "pointsweep/pipeline/sweep_engine.h"

namespace pointsweep {

struct RunState {
  /// Throws UsageError where an output is an input or another output; Error for a cloud without points.
  RunState(InputCloud& cloud, const Outputs& outputs, const EngineOptions& options, ChainPlan plan);

  InputCloud& cloud;
  const Outputs& outputs;
  const EngineOptions& options;
  std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();
  ChainPlan plan;
  FiniteInput input;                              ///< made before the rows of the cloud are counted
  std::vector<std::optional<OtherCloud>> others;  ///< that passes read beside the cloud, by pass
  std::optional<DecodedInput> decoded;            ///< from the survey on, of inputs that are decoded once
  Statistics statistics;
  OutputNames names;

  std::optional<Checkpoints> checkpoints;  ///< of a run that can be resumed
  Survey survey;                           ///< of the points that are put in order next
  OnDemandOrder on_demand;                 ///< whether that can be done by boxes; of the first pass
  std::optional<OutputLayout> layout;      ///< of the output's records; known when the survey has ended
  RunMemory memory;                        ///< the same
  std::optional<TempFolder> folder;        ///< of a run that spills or decodes and has no checkpoints

  std::optional<std::size_t> pass;      ///< whose phases run now; the number of passes: the output is put in order
  PointSource source;                   ///< the cloud as that pass sees it
  std::vector<Vec3> bucket_places;      ///< between buckets of edges, if it connects points
  std::optional<Stream> stream;         ///< its points in order: from its order to its sweep
  std::unique_ptr<RowStore> results;    ///< what it makes: from its order to its update, or to the output
  std::unique_ptr<RowFile> rows;        ///< what the pass before has left
  CloudValues values;                   ///< that are known by now
  std::optional<Reordering> reordered;  ///< the output's records while they are put in order
  std::optional<OutputSet> files;       ///< opened before the first pass, or after the last select
  MadeFolders folders;                  ///< of tiles
  std::optional<TileSet> tiles;         ///< in place of `files` where each input has its output

  /// The box of the moved points; absent where no stage moves points, or the output needs no box.
  std::optional<Box> moved_bounds() const;
  /// The engine that sweeps in place of the cells; null: none.
  const SweepEngine* other_engine() const { return engine_of(options.engine); }
  bool is_empty() const { return cloud.count() == 0; }  ///< a select has left no row
  bool is_last(std::size_t p) const { return p + 1 == plan.passes.size(); }
  /// Returns whether pass `p` makes whole output records in the order of its stream.
  bool makes_output(std::size_t p) const { return leaves_in_order(plan, options) && is_last(p); }
  std::string name_of_cloud() const;
  /// Returns the place for a spilled stream, "results", "rows" or "mask" of a pass.
  SpillPlace place(const char* kind, std::size_t p, bool spills) const;
  PointSource cloud_source();
  /// Adds the sentence to Statistics::warnings, unless it is empty, and tells the observer of it as a warning.
  void warn(const std::string& sentence);
  /// Adds the sentence to Statistics::warnings and tells the observer of it as a note.
  void note(const std::string& sentence);
  void report(const char* phase, std::uint64_t done, std::uint64_t active) const;
  /// Numbers of rows of the cloud before any select.
  std::vector<std::uint64_t> rows_of_cloud(std::vector<std::uint64_t> of_rows) const;
  /// Gives the rows of the degenerate results from `first` on these numbers.
  void number_degenerate_rows(std::size_t first);
};

/// All files that a run writes under names of their own.
std::vector<std::filesystem::path> written_files(const Outputs& outputs, const EngineOptions& options);

/// Seconds of wall time since `start`.
double seconds_since(std::chrono::steady_clock::time_point start);

}  // namespace pointsweep
