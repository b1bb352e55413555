// SPDX-License-Identifier: MIT
/// One tile of a run that many machines perform. They share a scratch, in which each task leaves what later tasks read:
/// the run goes on in rounds, and a task of a round needs nothing but the results of the rounds before (docs/adr/0021).
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

/// A kind of step. A round is of the kind of its first step.
enum class PartRoundKind : std::uint8_t {
  look,    ///< counts the points without a place, where they are dropped
  other,   ///< stores the points of a file of the other cloud that a pass reads
  order,   ///< puts the points of a tile in order and stores them for the other tiles
  sweep,   ///< takes the points of a tile, with those around it, through the stages of a pass, and ends the pass
  forest,  ///< grows the forest of a tile whose sweep has left a graph with weights, when the borders are found
  label,   ///< ends a pass whose sweep has left a graph, when the components of all tiles are joined
  rows,    ///< takes the rows of a tile through the stages of a pass that looks at no neighbour, and ends the pass
  write,   ///< writes the rows that the last pass has left
  cut,     ///< cuts a range of the rows into pieces, where the output is divided among files (division_tasks.h)
  gather,  ///< writes some of these files
};

/// The value that is made once all tasks of a round are done.
enum class PartJoin : std::uint8_t { nothing, tiles, borders, components, values, pieces };

struct PartStep {
  PartRoundKind kind;
  std::size_t pass = 0;
};

/// A task of each tile, of each file of another cloud, or of each range of a cloud whose output is divided. It takes
/// steps one after another.
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
  std::vector<std::uint64_t> counts = {};  ///< points, by file
};

struct PartPlan {
  std::vector<PartRound> rounds;
  std::vector<OtherFiles> others;
  std::vector<std::uint64_t> rows;  ///< by tile: how many rows its file has; by range, where the output is divided
  Nonfinite nonfinite = Nonfinite::keep;
  std::vector<std::string> record;  ///< the stages, as the outputs tell of them
  std::uint64_t scratch_bytes = 0;  ///< of a point in the scratch, at most
  std::vector<std::string> notes;   ///< what a run of one process would say before its work
};

/// Plans the chain for one tile, or all of them.
ChainPlan plan_of_parts(const InputCloud& cloud, const Chain& chain, const Outputs& outputs,
                        const EngineOptions& options);

/// Plans a run with a tile for each input from what the headers say. Throws UsageError for a run that cannot be divided
/// among tiles, and whatever run() throws before its work.
PartPlan plan_parts(InputCloud& cloud, const Chain& chain, const Outputs& outputs, const EngineOptions& options);

struct PartTask {
  PartRound round;
  std::size_t tile = 0, tiles = 0;
  std::uint64_t first_row = 0;           ///< rows of the files of the tiles before, or of the ranges before
  std::uint64_t rows = 0;                ///< of the file of the tile, or of the range
  std::uint64_t dropped = 0;             ///< points of all tiles that the look round has found
  std::string before;                    ///< name of what the task before has left of this tile; empty before the first
  std::string catalogue, values;         ///< of the rounds before; empty: there is none
  std::string borders;                   ///< of the rounds before; empty: there are none
  std::string components;                ///< of the round before; empty: there are none
  std::string pieces;                    ///< of the round before; empty: there are none
  std::string other_catalogue;           ///< of the other cloud that the pass reads; empty: it reads none
  std::string other_file;                ///< of that cloud: the one to store, or else any of them
  std::vector<std::string> record = {};  ///< PartPlan::record
  std::string after;                     ///< name for what this task leaves; no other task has it
};

struct PartDone {
  std::uint64_t rows = 0;                          ///< that are left
  std::uint64_t own_points = 0, swept_points = 0;  ///< of a sweep: of the tile, and with those around it
  Statistics statistics;
};

/// Performs a task. `tile`: the input of the tile, in a round over another cloud any of the inputs, where the output is
/// divided all of them. `outputs.tiles` has one path, which may be replaced, or none if the output is divided.
PartDone run_part(InputCloud& tile, const Chain& chain, const Outputs& outputs, const EngineOptions& options,
                  const PartTask& task, Storage& scratch);

/// PartJoin::tiles: seals the catalogue `key` of what the tasks have left, by tile or
/// file. `paths`: of these.
void join_tiles(Storage& scratch, const std::vector<std::string>& left, const std::vector<std::string>& paths,
                const std::string& key);

/// The keys of objects that earlier rounds have left of all tiles together.
struct JoinedBefore {
  std::string catalogue;     ///< of the pass
  std::string borders = "";  ///< empty: there are none
};

/// PartJoin::borders: finds the borders of the tiles and seals them under `key`. PartJoin::components: joins the
/// components of the tiles. `tile`: any input of the run.
void join_graph(InputCloud& tile, const Chain& chain, const Outputs& outputs, const EngineOptions& options,
                const PartRound& round, Storage& scratch, const JoinedBefore& before,
                const std::vector<std::string>& left, const std::string& key);

/// PartJoin::values: seals under `key` the values of the cloud of `before`, if that is not empty, and of
/// the round, which the tasks have left, by tile. `tile`: any input of the run.
void join_values(InputCloud& tile, const Chain& chain, const Outputs& outputs, const EngineOptions& options,
                 const PartRound& round, Storage& scratch, const std::string& before,
                 const std::vector<std::string>& left, const std::string& key);

/// PartJoin::pieces: seals under `key` what the files of a divided output consist of. `cloud`: all inputs.
void join_cuts(InputCloud& cloud, const Chain& chain, const Outputs& outputs, const EngineOptions& options,
               Storage& scratch, const std::vector<std::string>& left, const std::string& key);

/// The ends of the names of what tasks leave in the scratch. A task leaves some of them.
inline constexpr std::array kLeftByTasks{".points",     ".index",     ".state",   ".rows",  ".results", ".labels",
                                         ".components", ".crossings", ".numbers", ".nodes", ".edges",   ".marks",
                                         ".buckets",    ".forest",    ".pieces",  ".cut"};
/// Removes what a task has left. Nothing is said of what is not there.
void forget(Storage& scratch, const std::string& left);

}  // namespace pointsweep
