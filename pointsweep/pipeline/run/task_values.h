// SPDX-License-Identifier: MIT
/// Values that tasks of a run on many machines pass on to later tasks through the storage that all machines share
/// (part_run.h): the state of a tile, the values of the whole cloud, and the pieces of an output that is divided among
/// files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/order/survey.h"
#include "pointsweep/pipeline/output/divider.h"
#include "pointsweep/pipeline/rows/pass_update.h"
#include "pointsweep/storage/encoding.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// The state in which a task leaves its tile for the next task. Points, carried records and graphs are separate
/// objects, whose names begin with the name of the task that has stored them (PartTask::after).
struct TileState {
  Survey survey;                             ///< survey of the tile's input
  std::vector<std::vector<std::byte>> mask;  ///< blocks of the selection of rows; empty if all rows are left
  std::string carried;                       ///< name of the task that has stored the carried records; empty if none
  /// PassValues::save() of the last pass that has ended; empty after an order step.
  std::vector<std::vector<std::byte>> saved_values;
  std::string swept;  ///< name of the task whose sweep has stored a graph; empty if none

  void encode(Encoder& out) const;
  static TileState decode(Decoder& in);
  /// Seals this state in `scratch` as the object `name`.state.
  void seal(Storage& scratch, const std::string& name) const;
  /// Returns the state that seal() has stored for `name`.
  static TileState left(const Storage& scratch, const std::string& name);
};

/// Seals the values of the whole cloud under `key`.
void seal_values(Storage& scratch, const std::string& key, const CloudValues& values);
/// Returns the values that seal_values() has stored under `key`.
CloudValues sealed_values(const Storage& scratch, const std::string& key);

/// The pieces into which one range of rows is divided: for each file with records from the range, its key and its
/// numbers of points in the range. The records are stored in the order of the pieces.
struct PiecesOfRange {
  std::vector<DividedFile> pieces;

  void encode(Encoder& out) const;
  static PiecesOfRange decode(Decoder& in);
};

/// Records [first, first + count) of a range, which belong to one file.
struct PieceOfFile {
  std::uint64_t range, first, count;
};

/// The files of all ranges together, in the order of their keys.
struct FilesOfRanges {
  std::vector<std::string> ranges;  ///< names under which the tasks of the ranges have stored their results
  std::vector<DividedFile> files;
  std::vector<std::vector<PieceOfFile>> pieces;  ///< pieces of each file, in the order of rows

  void encode(Encoder& out) const;
  static FilesOfRanges decode(Decoder& in);
  /// Returns the indices of the files that task `task` of `tasks` writes. The tasks get about equal numbers of points,
  /// as far as whole files allow.
  std::vector<std::size_t> of_task(std::size_t task, std::size_t tasks) const;
};

/// Joins the pieces of all ranges. `names` and `pieces` have an element for each range, in the order of rows.
FilesOfRanges files_of(const std::vector<std::string>& names, std::span<const PiecesOfRange> pieces);

}  // namespace pointsweep
