// SPDX-License-Identifier: MIT
/// The outputs of a run, and the facts that must be known when they are opened.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/formats/files/folders.h"
#include "pointsweep/pipeline/output/output_set.h"
#include "pointsweep/pipeline/output/tile_set.h"
#include "pointsweep/pipeline/run/phases.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Returns whether the bounds of all points must be found before the first record is written. True if the format of
/// Outputs::points stores coordinates as integers, the output does not take over the integers of the input (a stated
/// scale or offset counts as a change), and neither a stage that moves points nor the check for nonfinite points makes
/// the bounds known.
bool needs_bounds(const Context& context);

/// Returns the texts of the stages for the processing record of a run (formats/provenance.h). The neighbourhood is the
/// first text, unless the stages search no neighbours. The only text is "sort" for a sort, and "convert" without
/// stages.
std::vector<std::string> recorded_stages(const ChainPlan& plan);

/// The output of a run that only copies rows (copies_rows()), and memory for dividing it.
struct CopyPlan {
  OutputPlan output;             ///< plan of one file with all rows
  std::uint64_t division_bytes;  ///< memory for dividing the output (DivisionRoom::bytes)
};
CopyPlan plan_copy(const Context& context, const WorkPlan& work);

/// The outputs: one set of files, or one tile for each input.
class OutputFiles {
 public:
  /// Throws for outputs that cannot be written, as far as this is known before the work. `bounds`: bounds of the input;
  /// may be empty.
  void require_writable(const Context& context, const Box& bounds);
  /// Opens the outputs. If ChainPlan::opens_late(), only checks that they can be written.
  void open(const Context& context, const WorkPlan& work, const Survey& survey, const Rows& rows);
  /// Opens the outputs after the passes. Must not be called if are_open(). `survey`: survey of the points that were put
  /// in order last, or of the input if none were; if needs_bounds(), all points are surveyed again.
  void open_late(const Context& context, const WorkPlan& work, Survey survey, const Rows& rows);
  bool are_open() const { return files_ || tiles_; }
  bool are_tiles() const { return tiles_.has_value(); }

  /// Writes the next rows of the cloud with their results.
  void write_results(InputCloud& cloud, std::uint64_t first, std::span<const std::byte> results);
  /// Writes the next rows of the cloud without results. Must be called for tiles only.
  void write_tiled_inputs(std::uint64_t rows) { tiles_->write_inputs(rows); }
  /// Writes the next records of the input without results. Must not be called for tiles.
  void write_inputs(std::uint64_t first, std::span<const std::byte> records) { files_->write_inputs(first, records); }
  /// Writes the next records of the input as one piece (OutputSet::write_piece). Must not be called for tiles.
  void write_piece(std::uint64_t first, std::vector<std::byte>& records) { files_->write_piece(first, records); }
  /// Writes the next whole output records. Must not be called for tiles.
  void write_records(std::span<const std::byte> records) { files_->write_records(records); }

  /// Completes the outputs, renames them to their destinations, and reports their warnings, their bytes and the number
  /// of complete point files.
  void finish(const Context& context);
  /// Returns a sentence about the number of complete tiles, to append to an error. Empty if none is complete.
  std::string progress() { return tiles_ ? tiles_->progress() : ""; }

 private:
  void make_folder(const Context& context);
  void open_files(const Context& context, const WorkPlan& work, const Survey& survey, const Rows& rows);

  MadeFolders folders_;  ///< folders made for tiles or for the files of a divided output
  std::optional<OutputSet> files_;
  std::optional<TileSet> tiles_;
};

}  // namespace pointsweep
