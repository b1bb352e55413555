// SPDX-License-Identifier: MIT
/// The outputs of a run, when they are opened, and what is known of their content then.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/formats/files/made_folders.h"
#include "pointsweep/pipeline/output/output_set.h"
#include "pointsweep/pipeline/output/tile_set.h"
#include "pointsweep/pipeline/run/phases.h"

namespace pointsweep {

/// Returns whether a format needs the bounds before the first record: a format that stores integers, unless the records
/// hold these integers already.
bool needs_bounds(const Context& context);

/// Returns the stages of the record of a run. A chain that searches no neighbours has no neighbourhood there.
std::vector<std::string> recorded_stages(const ChainPlan& plan);

/// One set of files, or a tile for each input.
class OutputFiles {
 public:
  /// Throws if the outputs cannot be written, as far as this is known before the work. `bounds`: of the input; may be
  /// empty.
  void require_writable(const Context& context, const Box& bounds);
  /// Before the first pass. Where a select leaves out rows, only makes sure that they can be written.
  void open(const Context& context, const WorkPlan& work, const Survey& survey, const Rows& rows);
  /// After the passes of a run that has left out rows. `survey`: of the order of the output, if it has one.
  void open_late(const Context& context, const WorkPlan& work, Survey survey, const Rows& rows);
  bool are_open() const { return files_ || tiles_; }
  bool are_tiles() const { return tiles_.has_value(); }

  /// Writes the next rows of the cloud with their results.
  void write_results(InputCloud& cloud, std::uint64_t first, std::span<const std::byte> results);
  /// Of tiles: writes the next rows of the cloud, for which no results were made.
  void write_tiled_inputs(std::uint64_t first, std::uint64_t rows) { tiles_->write_inputs(first, rows); }
  /// Of one set: writes the next records of the input, for which no results were made.
  void write_inputs(std::uint64_t first, std::span<const std::byte> records) { files_->write_inputs(first, records); }
  /// Of one set: writes the next records of the input as one piece (OutputSet::write_piece).
  void write_piece(std::uint64_t first, std::vector<std::byte>& records) { files_->write_piece(first, records); }
  /// Of one set: writes the next whole output records.
  void write_records(std::span<const std::byte> records) { files_->write_records(records); }

  /// The outputs get their names.
  void finish(const InputCloud& cloud);
  std::vector<std::string> warnings() const { return tiles_ ? tiles_->warnings() : files_->warnings(); }
  std::uint64_t bytes_written() const { return tiles_ ? tiles_->bytes_written() : files_->bytes_written(); }
  /// Returns an addition to the sentence of an error: how many tiles are complete. Empty if none is.
  std::string progress() { return tiles_ ? tiles_->progress() : ""; }

  /// Returns the number of point files that are complete.
  std::size_t files_written() const { return tiles_ ? tiles_->files_written() : files_->files_written(); }

 private:
  void make_folder(const Context& context);
  void open_files(const Context& context, const WorkPlan& work, const Survey& survey, const Rows& rows);

  MadeFolders folders_;  ///< of many files
  std::optional<OutputSet> files_;
  std::optional<TileSet> tiles_;
};

}  // namespace pointsweep
