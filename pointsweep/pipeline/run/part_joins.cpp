// SPDX-License-Identifier: MIT
/// Joins the results of all tasks of a round (PartJoin).
#include "pointsweep/part/tile_forest.h"
#include "pointsweep/part/tile_graph.h"
#include "pointsweep/part/tile_catalogue.h"
#include "pointsweep/pipeline/memory_plan.h"
#include "pointsweep/pipeline/rows/pass_values.h"
#include "pointsweep/pipeline/run/context.h"
#include "pointsweep/pipeline/run/division_tasks.h"
#include "pointsweep/pipeline/run/part_run.h"
#include "pointsweep/pipeline/run/tile_state.h"
#include "pointsweep/storage/sealed_value.h"

namespace pointsweep {

void join_tiles(Storage& scratch, const std::vector<std::string>& left, const std::vector<std::string>& paths,
                const std::string& key) {
  const TileCatalogue tiles = catalogue_of(scratch, left, paths);
  seal_bytes(scratch, key, encoded(tiles));
}

void join_values(InputCloud& tile, const Chain& chain, const Outputs& outputs, const EngineOptions& options,
                 const PartRound& round, Storage& scratch, const std::string& before,
                 const std::vector<std::string>& left, const std::string& key) {
  CloudValues values = before.empty() ? CloudValues() : sealed_values(scratch, before);
  std::vector<std::vector<std::vector<std::byte>>> saved;
  for (const std::string& name : left) saved.push_back(TileState::left(scratch, name).saved_values);
  finish_values(plan_of_parts(tile, chain, outputs, options).passes.at(round.steps.back().pass), saved, values);
  seal_values(scratch, key, values);
}

void join_graph(InputCloud& tile, const Chain& chain, const Outputs& outputs, const EngineOptions& options,
                const PartRound& round, Storage& scratch, const JoinedBefore& before,
                const std::vector<std::string>& left, const std::string& key) {
  const ChainPlan plan = plan_of_parts(tile, chain, outputs, options);
  const ConnectOperator& op = *plan.passes.at(round.steps.back().pass).connecting_stage()->connects();
  RunPlaces places(options, {});
  const TileGraphSetup setup{
      op.votes(), places.scratch(), &places.folder(), memory_budget(options.resources.memory_bytes) / 2, {}};
  const auto tiles = sealed_value<TileCatalogue>(scratch, before.catalogue);
  if (round.join == PartJoin::borders)
    find_borders(scratch, tiles, left, setup, key);
  else if (op.weighted())
    join_forests(scratch, left, before.borders, setup, key);
  else
    join_graphs(scratch, tiles, left, setup, key);
}

void join_cuts(InputCloud& cloud, const Chain& chain, const Outputs& outputs, const EngineOptions& options,
               Storage& scratch, const std::vector<std::string>& left, const std::string& key) {
  join_pieces({cloud, chain, outputs, options}, scratch, left, key);
}

void forget(Storage& scratch, const std::string& left) {
  for (const char* const end : kLeftByTasks) scratch.remove(left + end);
}

}  // namespace pointsweep
