// SPDX-License-Identifier: MIT
/// Tasks of a run that many machines perform. The machines share a storage, the scratch, in which each task stores what
/// later tasks read. The run proceeds in rounds: a task needs only results of earlier rounds, so that the tasks of a
/// round run in any order on any machine (docs/adr/0021). The halo of a tile is the points of other tiles near it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// A request for a run that many processes share.
struct SharedRequest {
  InputCloud& cloud;  ///< one tile or all inputs; each function states which it needs
  const Chain& chain;
  const Outputs& outputs;
  const EngineOptions& options;
};

/// Resolves the chain against the fields of the cloud.
ChainPlan plan_of(const SharedRequest& request);

/// The kind of a step, which a task performs. The kind of a round is the kind of its first step.
enum class PartRoundKind : std::uint8_t {
  look,    ///< counts the points with non-finite coordinates if these are dropped; fails if they are refused
  other,   ///< stores the points of a file of the other cloud that a pass reads
  order,   ///< puts the points of a tile in order and stores them for the other tiles
  sweep,   ///< takes the points of a tile and its halo through the stages of a pass; ends the pass if it makes no graph
  forest,  ///< grows the spanning forest of a tile's weighted graph, after the borders of all tiles have been found
  label,   ///< ends a pass whose sweep has stored a graph, after the components of all tiles have been joined
  rows,    ///< takes the rows of a tile through the stages of a pass that looks at no neighbour, and ends the pass
  write,   ///< writes the rows that the last pass has left
  cut,     ///< divides a range of rows into pieces of output files, if the output is divided (cut_range())
  gather,  ///< writes some of the files of a divided output from their pieces
};

/// The value that one process makes from the results of all tasks of a round, after the last task.
enum class PartJoin : std::uint8_t { nothing, tiles, borders, components, values, pieces };

struct PartStep {
  PartRoundKind kind;
  std::size_t pass = 0;
};

/// A round: a task for each tile, for each file of another cloud, or, if the output is divided, for each range of rows.
/// Each task takes the steps one after another.
struct PartRound {
  std::vector<PartStep> steps;
  PartJoin join = PartJoin::nothing;

  PartRoundKind kind() const { return steps.front().kind; }
  std::size_t pass() const { return steps.front().pass; }
};

/// The files of the other cloud that a pass reads.
struct OtherFiles {
  std::size_t pass = 0;
  std::vector<std::string> paths = {};
  std::vector<std::uint64_t> counts = {};  ///< number of points of each file
};

struct PartPlan {
  std::vector<PartRound> rounds;
  std::vector<OtherFiles> others;
  std::vector<std::uint64_t> rows;  ///< number of rows of each tile; of each range of rows if the output is divided
  Nonfinite nonfinite = Nonfinite::keep;
  std::vector<std::string> record;  ///< recorded_stages(), for the processing record of the outputs
  std::uint64_t scratch_bytes = 0;  ///< estimate of the most bytes that the scratch stores for each point
  std::vector<std::string> notes;   ///< sentences for the user, which a run of one process reports before its work
};

/// Plans a run from the headers of the inputs: with a tile for each input or, if the output is divided, with ranges of
/// rows. Throws UsageError for a run that cannot be divided in this way, and the errors that run() throws before its
/// work. `request`: all inputs.
PartPlan plan_parts(const SharedRequest& request);

struct PartTask {
  PartRound round;
  /// Number of the task's tile (or file of another cloud, or range), counted from 0, and number of all tiles (or
  /// ranges).
  std::size_t tile = 0, tiles = 0;
  std::uint64_t first_row = 0;  ///< number of rows in the files of earlier tiles, or in earlier ranges
  std::uint64_t rows = 0;       ///< number of rows in the file of the tile, or in the range
  std::uint64_t dropped = 0;    ///< number of non-finite points that the look round has counted in all tiles
  std::string before;           ///< name of the results of the previous task of this tile; empty for the first task
  /// Keys of the last sealed TileCatalogue of the inputs and of the last sealed values of the whole cloud. A key is
  /// empty while no earlier round has made its object.
  std::string catalogue, values;
  std::string borders;          ///< key of the last sealed borders of tiles; empty while no round has found any
  std::string components;       ///< key of the last joined components; empty while no round has joined any
  std::string pieces;           ///< key of the list of pieces of a divided output; empty before the rows are cut
  std::string other_catalogue;  ///< key of the TileCatalogue of the other cloud; empty if the pass reads no other cloud
  std::string other_file;       ///< file of the other cloud: the file to store, or for later rounds any of its files
  std::vector<std::string> record = {};  ///< PartPlan::record
  std::string after;                     ///< unique name under which this task stores its results
};

struct PartDone {
  std::uint64_t rows = 0;  ///< number of rows of the tile after the task, or of the stored file of another cloud
  /// Number of finite points of the tile that were ordered or swept, and number of points that were swept: those of the
  /// tile and of its halo. 0 if the task has no such step.
  std::uint64_t own_points = 0, swept_points = 0;
  Statistics statistics;
};

/// Performs a task. The cloud of the request is the input of the tile; any input in a round over another cloud; all
/// inputs if the output is divided. Outputs::tiles has one path, whose file may be replaced, or none if the output is
/// divided.
PartDone run_part(const SharedRequest& request, const PartTask& task, Storage& scratch);

/// Performs PartJoin::tiles: seals under `key` the catalogue of the tiles or files that tasks have stored under the
/// names `left`. `paths`: the paths of these tiles or files, for messages.
void join_tiles(Storage& scratch, const std::vector<std::string>& left, const std::vector<std::string>& paths,
                const std::string& key);

/// The keys of objects that earlier joins have made from all tiles.
struct JoinedBefore {
  std::string catalogue;     ///< key of the TileCatalogue of the pass
  std::string borders = "";  ///< key of the borders of all tiles; empty if none have been found
};

/// Performs PartJoin::borders, which finds the borders of the tiles, or PartJoin::components, which joins the
/// components of the tiles, and seals the result under `key`. `left`: names of the tasks' results. `request`: any input
/// of the run.
void join_graph(const SharedRequest& request, const PartRound& round, Storage& scratch, const JoinedBefore& before,
                const std::vector<std::string>& left, const std::string& key);

/// Performs PartJoin::values: computes the values of the whole cloud that the round finds, from the results of tasks
/// with the names `left`, and seals them under `key` together with the values under the key `before`, unless that key
/// is empty. `request`: any input of the run.
void join_values(const SharedRequest& request, const PartRound& round, Storage& scratch, const std::string& before,
                 const std::vector<std::string>& left, const std::string& key);

/// The suffixes of the objects that tasks store in the scratch. A task stores objects with some of these suffixes, or
/// none if it only writes outputs.
inline constexpr std::array kLeftByTasks{".points",     ".index",     ".state",   ".rows",  ".results", ".labels",
                                         ".components", ".crossings", ".numbers", ".nodes", ".edges",   ".marks",
                                         ".buckets",    ".forest",    ".pieces",  ".cut"};
/// Removes all objects that a task has stored under the name `left`. Missing objects are no error.
void forget(Storage& scratch, const std::string& left);

// The functions below plan and perform the tasks of a run that divides its points among files (`tile`, `split`). Each
// task of the first round cuts a range of the rows into pieces, one for each file with points in the range; each task
// of the second round writes some of the files from the pieces of all ranges. All tasks open all inputs, so that they
// plan the same layout for the output. The chain has no stages, but may name the attributes to keep; Outputs::points is
// the path of the files, with a * for their names.

/// Returns the number of rows of each range. Throws UsageError for a chain with stages; for inputs that may have
/// nonfinite points, unless these are kept; and if copies_rows() is false on one thread, for example because the layout
/// of the output depends on all points.
std::vector<std::uint64_t> plan_ranges(const SharedRequest& request);
/// Returns the bytes of the record of a point in the pieces. Throws for outputs that cannot be written, as far as this
/// is known before the work.
std::uint64_t piece_bytes(const SharedRequest& request);

struct RowRange {
  std::uint64_t first = 0, rows = 0;
};
/// Divides the rows of a range among files. Stores the records under `name`.pieces and their PiecesOfRange under
/// `name`.cut in `scratch`, which all processes share. The options of cut_range() and write_pieces() must allow files
/// to be replaced, since plan_parts() and join_pieces() refuse existing files.
Statistics cut_range(const SharedRequest& request, RowRange range, Storage& scratch, const std::string& name);

/// Performs PartJoin::pieces: seals the list of all files and their pieces (FilesOfRanges) under `key`. `names`: names
/// given to cut_range(), in the order of the ranges. Throws if one of the files cannot be written.
void join_pieces(const SharedRequest& request, Storage& scratch, const std::vector<std::string>& names,
                 const std::string& key);

/// Writes the files of task `task`, counted from 0, of `tasks` tasks. `key`: key given to join_pieces().
Statistics write_pieces(const SharedRequest& request, std::size_t task, std::size_t tasks, const Storage& scratch,
                        const std::string& key);

}  // namespace pointsweep
