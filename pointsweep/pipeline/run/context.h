// SPDX-License-Identifier: MIT
/// Values that all phases of a run share: the request, its plan, the places for temporary data, and the report on the
/// run.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/pipeline/checkpoint/checkpoints.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/output/output_formats.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/points/scratch.h"
#include "pointsweep/row_error.h"
#include "pointsweep/storage/local/temp_folder.h"

namespace pointsweep {

/// The places for the temporary data of a run: the folder of its checkpoints, if it can be resumed, for data that later
/// phases or a resumed run need, and a temporary folder, made on first use, for all other data.
class RunPlaces {
 public:
  /// `identity`: identity of a run that can be resumed; absent for other runs. Throws the errors of Checkpoints().
  RunPlaces(const EngineOptions& options, const std::optional<std::string>& identity);
  /// Returns the checkpoints; null for a run that cannot be resumed.
  Checkpoints* checkpoints() { return checkpoints_ ? &*checkpoints_ : nullptr; }
  /// Returns the place for the "decoded" records of all inputs, for the "stream" or the "results" of pass `number`, or
  /// for the "rows" and the "mask" with which this pass begins. The place is a kept file if there are checkpoints,
  /// otherwise folder() if `spills`, else memory.
  SpillPlace place(const char* kind, std::size_t number, bool spills);
  /// Returns the temporary folder, for data that neither later passes nor a resumed run need. Thread-safe.
  const TempFolder& folder();
  /// Returns a function that makes files in folder(). *this must outlive the function, which is thread-safe.
  MakeScratch scratch();

 private:
  std::filesystem::path temp_folder_;
  std::optional<Checkpoints> checkpoints_;
  std::mutex making_;  ///< mutex that guards `folder_`
  std::optional<TempFolder> folder_;
};

/// Passes warnings and notes to the observer and the statistics of a run.
struct RunReport {
  Statistics& statistics;
  Observer* observer;  ///< receives progress and sentences; may be null

  /// Adds `sentence` to Statistics::warnings, and passes it to the observer as a warning. No-op if it is empty.
  void warn(const std::string& sentence) const;
  /// Adds `sentence` to Statistics::warnings, and passes it to the observer as a note.
  void note(const std::string& sentence) const;
};

/// One tile of a run in which other processes work on the other tiles.
struct PartOfRun {
  std::size_t tile = 0, tiles = 0;       ///< number of this tile, counted from 0, and number of all tiles
  bool drops_nonfinite = false;          ///< true if nonfinite points of any tile have been dropped
  std::vector<std::string> stages = {};  ///< recorded_stages() of the whole run, for the processing record
};

struct Context {
  InputCloud& cloud;  ///< the rows of the input that no earlier pass has dropped
  const Outputs& outputs;
  const EngineOptions& options;
  const ChainPlan& plan;
  const OutputNames& names;
  const NonfiniteRows& dropped;  ///< nonfinite points that were dropped before the run
  RunPlaces& places;
  const RunReport& report;
  std::uint64_t input_bytes = 0;       ///< result of open_input_bytes() before inputs are decoded
  bool copies_rows = false;            ///< result of copies_rows() for the request
  std::optional<PartOfRun> part = {};  ///< absent if this process runs over all points

  /// Returns the context of a phase that begins with the rows `left`, which must outlive the context.
  Context over(InputCloud& left) const;
  Statistics& statistics() const { return report.statistics; }
  bool is_empty() const { return cloud.count() == 0; }  ///< returns whether no row is left
  /// Returns the bytes for the open inputs, for decoding those that are not decoded into a temporary file, for encoding
  /// records of `record_bytes` on `threads` threads, and, if the output is divided, the least memory for dividing it.
  std::uint64_t codec_bytes(std::uint64_t record_bytes, unsigned threads) const;
  /// Returns whether pass `p` makes whole output records in the order of its stream.
  bool makes_output(std::size_t p) const;
  /// Returns the selected rows of the cloud as a source that adds the bytes of each record read to
  /// Statistics::bytes_read.
  PointSource cloud_source() const;
  /// Tells the observer how many points of the phase are done, and how many points are in memory.
  void progress(const char* phase, std::uint64_t done, std::uint64_t active = 0) const;
  /// Returns the function that tells the observer how many points of the phase are done.
  std::function<void(std::uint64_t)> progress_of(const char* phase) const;
  /// Converts numbers of selected rows into numbers of rows of the whole cloud.
  std::vector<std::uint64_t> rows_of_cloud(std::vector<std::uint64_t> of_rows) const;
  /// Returns the error with the number of the row in its input file instead of the number among the selected rows, and
  /// with the name of the file if there are several inputs.
  RowError located(const RowError& error) const;
  /// Converts the rows of the degenerate results from index `first` on into rows of the whole cloud.
  void number_degenerate_rows(std::size_t first) const;
};

/// Returns the seconds of wall time since `start`.
double seconds_since(std::chrono::steady_clock::time_point start);

}  // namespace pointsweep
