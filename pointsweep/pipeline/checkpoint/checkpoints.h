// SPDX-License-Identifier: MIT
/// The checkpoints of a run, from which another process can continue it, and the identity of a run, a text that must be
/// equal in both processes.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "pointsweep/order/row_store.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/pipeline/checkpoint/resume_folder.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/pipeline/rows/pass_update.h"
#include "pointsweep/storage/encoding.h"
#include "pointsweep/sweep/sweep.h"

namespace pointsweep {

/// Returns lines of text: the version of pointsweep and of its checkpoints, inputs (with size and time, or ETag),
/// outputs, points of a cell, options that change outputs, the coordinate system that the user states, the pipeline
/// with every option of every stage, passes, and the fields that are kept. Throws Error if an input is neither a file
/// nor a URL, since its changes could not be detected.
std::string run_identity(const InputCloud& cloud, const ChainPlan& plan, const Outputs& outputs,
                         const EngineOptions& options);

/// Throws Error, which names the first different line, if `checkpoint`, an identity from `folder`, differs from `now`.
void require_same_run(const std::string& checkpoint, const std::string& now, const std::filesystem::path& folder);

/// The state of a run at a checkpoint. During a pass that puts points in order, `stream` is set first, when the points
/// are in order. During the sweep, `results` and `progress` are set, too. After the sweep only `results` is set. None
/// of the three is set after the update, when the results have become the rows of the next pass.
struct Checkpoint {
  std::uint64_t memory_bytes = 0;  ///< the budget, for a resumed run that states none
  Survey survey;                   ///< survey of the input, from which a resumed run also plans its memory
  std::uint64_t sweep = 0;  ///< number of the pass to begin or to continue; the rows carried into the pass are complete
  std::uint64_t slab_points = 0;    ///< intended number of points of a slab, the unit in which `stream` is read
  std::vector<std::byte> stream;    ///< encoded Stream; empty before the points are in order and after the sweep
  std::vector<Vec3> bucket_places;  ///< Ordered::bucket_places (run/phases.h); empty after the sweep
  std::optional<Survey> ordered;    ///< Ordered::survey of the last points that were put in order
  std::vector<std::byte> results;   ///< encoded RowStore; empty before the first slab
  std::vector<std::byte> progress;  ///< encoded SweepProgress; empty before the first slab
  std::uint64_t mask = 0;           ///< number of the pass after the last pass that dropped rows; 0: all rows remain
  std::vector<std::vector<double>> values;  ///< values of the whole cloud, by PlannedValue::number; empty: not known
  Statistics counts;                        ///< counts of the finished sweeps, for take_counts()

  bool is_in_order() const { return !stream.empty(); }
  bool is_swept() const { return stream.empty() && !results.empty(); }

  void encode(Encoder& out) const;
  static Checkpoint decode(Decoder& in);
};

/// Copies the number of sweeps, the counts of certified, recalled, degenerate and non-finite points, the peak of the
/// window and the degenerate results; copies neither times nor bytes nor series.
void take_counts(Statistics& to, const Statistics& from);

/// Saves the checkpoints of a run in its folder.
class Checkpoints {
 public:
  /// Throws Error if the folder cannot be used or holds another run.
  Checkpoints(const EngineOptions& options, const std::string& identity);

  /// Returns the last checkpoint; at first, the checkpoint that an earlier process has left.
  const Checkpoint& last() const { return last_; }
  bool found() const { return found_; }  ///< returns whether an earlier process has left a checkpoint
  /// Returns the place of a file of the run. `kind`: "stream" or "results" of pass `sweep`, "rows" or "mask" with which
  /// this pass begins, or "decoded" (RunPlaces::place).
  SpillPlace place(const char* kind, std::uint64_t sweep) const;
  std::optional<SweepProgress> progress() const;
  /// Throws Error if the saved stream was cut into slabs of more than `slab_points`, as a process with more memory or
  /// fewer threads does.
  void require_slabs_of(std::uint64_t slab_points) const;

  /// Sets the survey and the memory budget of the run, which later checkpoints contain.
  void surveyed(const Survey& survey, std::uint64_t memory_bytes);
  /// Saves a checkpoint, unless last() already has the points in order. Must be called when the points are in order.
  /// `survey`, `bucket_places`: those of Ordered.
  void in_order(const Stream& stream, std::uint64_t slab_points, const Survey& survey,
                const std::vector<Vec3>& bucket_places);
  /// Saves a checkpoint. Must be called when the sweep of the pass is complete.
  void swept(RowStore& results, const Statistics& counts);
  /// Saves a checkpoint. Must be called when the rows for the next pass are complete. `selects`: the pass has left out
  /// rows, and its mask is complete too.
  void updated(bool selects, const CloudValues& values, const Statistics& counts);
  /// Saves a checkpoint if neither this nor an earlier process has saved one, because the list of complete tiles is
  /// useless without a checkpoint. Must be called before the first tile is renamed to its destination.
  void writing_tiles();
  /// Removes the folder. Must be called when the run is complete.
  void finish() { folder_.remove(); }

  bool is_due() const;
  void in_sweep(const SweepProgress& progress, RowStore& results);

 private:
  void save(std::chrono::steady_clock::time_point begun);
  std::set<std::string> files() const;

  ResumeFolder folder_;
  std::string identity_;  ///< run_identity() of the run
  Checkpoint last_;
  bool found_ = false;
  bool has_saved_ = false;
  std::chrono::duration<double> least_interval_, interval_;
  std::chrono::steady_clock::time_point saved_at_ = std::chrono::steady_clock::now();
};

/// Stores the progress of a sweep in the checkpoints, with the results so far.
class CheckpointKeeper final : public ProgressKeeper {
 public:
  CheckpointKeeper(Checkpoints& checkpoints, RowStore& results) : checkpoints_(checkpoints), results_(results) {}
  bool wants_progress() override { return checkpoints_.is_due(); }
  void keep(const SweepProgress& progress) override { checkpoints_.in_sweep(progress, results_); }

 private:
  Checkpoints& checkpoints_;
  RowStore& results_;
};

}  // namespace pointsweep
