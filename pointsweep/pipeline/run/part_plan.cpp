// SPDX-License-Identifier: MIT
/// The client of a run on many machines: refuses runs that cannot be divided, lists the rounds, and joins the results
/// of all tasks of a round (PartJoin), except the pieces of a divided output (division_tasks.cpp).
#include <fmt/format.h>

#include <algorithm>

#include "pointsweep/fail.h"
#include "pointsweep/part/tile_catalogue.h"
#include "pointsweep/part/tile_forest.h"
#include "pointsweep/part/tile_graph.h"
#include "pointsweep/pipeline/available_memory.h"
#include "pointsweep/pipeline/memory_plan.h"
#include "pointsweep/pipeline/rows/input_source.h"
#include "pointsweep/pipeline/rows/nonfinite_points.h"
#include "pointsweep/pipeline/rows/other_cloud.h"
#include "pointsweep/pipeline/rows/pass_update.h"
#include "pointsweep/pipeline/run/context.h"
#include "pointsweep/pipeline/run/output_files.h"
#include "pointsweep/pipeline/run/part_run.h"
#include "pointsweep/pipeline/run/phases.h"
#include "pointsweep/pipeline/run/request.h"
#include "pointsweep/pipeline/run/task_values.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {
namespace {

/// Estimated bytes of a point in a graph with weights, including its ballot (VoteRule) and 1.4 edges.
constexpr std::uint64_t kGraphBytes = 160;

/// Throws UsageError for a run that needs all points in one process, so that it cannot be divided among tiles.
void require_divisible(const ChainPlan& plan, const Outputs& outputs, const EngineOptions& options) {
  const auto refuse = [](const std::string& what) {
    fail_usage("{}; run it in one process, without a client or --dask.", what);
  };
  if (outputs.tiles.empty()) fail_usage("Many processes write a file for each input: name a folder as the output.");
  if (options.order == Order::sweep || plan.reorders) refuse("The rows of all tiles cannot be put in one order");
  if (!options.resume_folder.empty()) refuse("A run of many processes goes on from its scratch, not from checkpoints");
  if (options.engine != Engine::exact) refuse("The reference engine needs all points in one process");
  for (const PlannedPass& pass : plan.passes) {
    const InOrderOperator* const op = pass.in_order();
    if (op != nullptr && (!op->reach() || (!op->other_cloud().empty() && !op->other_reach())))
      refuse(fmt::format("'{}' cannot be divided among tiles yet", pass.in_order()->name()));
  }
}

/// Throws UsageError if stages move points, inputs are LAS or made from LAS but have no common coordinate grid, and the
/// user does not state both scale and offset. All outputs need the same grid before the work, and only the inputs or
/// the user can give it.
void require_common_grid(const InputCloud& cloud, const ChainPlan& plan, const EngineOptions& options) {
  const bool moves = plan.graph.moved_bounds.has_value();
  const bool stated = options.layout.scale.has_value() && options.layout.offset.has_value();
  const auto x = cloud.schema().find("x");
  const Type type = x ? cloud.schema().fields[*x].type : Type::f64;
  const bool on_grid = type != Type::f32 && type != Type::f64;
  if (moves && !on_grid && !stated && cloud.las())
    fail_usage(
        "The tiles lie on several grids, and their points are moved: give the grid of the outputs with --scale and "
        "--offset.");
}

/// Largest average number of tiles whose boxes contain a point. A task reads all tiles that overlap its own, so that
/// with more overlap the division of work gains little.
constexpr double kMostTilesOfAPoint = 3;

/// Throws UsageError for tiles that cover each other, according to the boxes in their headers.
void require_apart(const InputCloud& cloud) {
  std::vector<TileExtent> extents;
  for (const auto& reader : cloud.readers())
    extents.push_back({reader->info().bounds.value_or(Box{}), reader->info().count});
  const double covered = mean_tiles_of_a_point(extents);
  if (covered > kMostTilesOfAPoint)
    fail_usage(
        "The inputs cover each other: each point lies in the boxes of {:.1f} of them on average, and each task would "
        "read the points of as many. Cut them into tiles first: pointsweep tile INPUTS FOLDER --size LENGTH.",
        covered);
}

/// Adds a step to the last round if that round needs no join, and both the round and the step work on tiles of the
/// input. Otherwise adds it to a new round.
void add_step(PartPlan& made, PartStep step, PartJoin join) {
  const auto is_own = [](PartRoundKind kind) { return kind != PartRoundKind::look && kind != PartRoundKind::other; };
  const bool begins = made.rounds.empty() || made.rounds.back().join != PartJoin::nothing ||
                      !is_own(made.rounds.back().kind()) || !is_own(step.kind);
  if (begins) made.rounds.push_back({});
  made.rounds.back().steps.push_back(step);
  made.rounds.back().join = join;
}

void add_phase(const ChainPlan& plan, const Phase& phase, PartPlan& made) {
  const std::size_t p = phase.pass;
  const bool is_pass = p < plan.passes.size();
  const bool values = is_pass && !plan.passes[p].values.empty() && plan.leaves_rows(p);
  const PartJoin join = values ? PartJoin::values : PartJoin::nothing;
  if (phase.kind == PhaseKind::order) {
    if (std::ranges::find(made.others, p, &OtherFiles::pass) != made.others.end())
      add_step(made, {PartRoundKind::other, p}, PartJoin::tiles);
    add_step(made, {PartRoundKind::order, p}, PartJoin::tiles);
  }
  if (phase.kind == PhaseKind::sweep) {
    const Stage* const connecting = plan.passes[p].connecting_stage();
    const bool weighted = connecting != nullptr && connecting->connects()->weighted();
    const PartJoin of_graph = weighted ? PartJoin::borders : PartJoin::components;
    add_step(made, {PartRoundKind::sweep, p}, connecting != nullptr ? of_graph : join);
    if (weighted) add_step(made, {PartRoundKind::forest, p}, PartJoin::components);
    if (connecting != nullptr) add_step(made, {PartRoundKind::label, p}, join);
  }
  const bool ends = phase.kind == PhaseKind::update || phase.kind == PhaseKind::write;
  if (ends && is_pass && plan.passes[p].kind == PassKind::rows) add_step(made, {PartRoundKind::rows, p}, join);
  if (ends && !is_pass) add_step(made, {PartRoundKind::write, p}, PartJoin::nothing);
}

std::vector<OtherFiles> other_files(const Request& request, const RunReport& report) {
  std::vector<OtherFiles> files;
  const OtherClouds others = open_other_clouds(request, report);
  for (std::size_t p = 0; p < others.size(); ++p) {
    if (!others[p]) continue;
    others[p]->require_same_types();
    files.push_back({.pass = p, .counts = others[p]->counts()});
    for (const std::filesystem::path& path : others[p]->files()) files.back().paths.push_back(path.string());
  }
  return files;
}

/// Plans a run whose output is divided among files. Its tasks take ranges of rows and groups of files instead of tiles.
PartPlan plan_division(const SharedRequest& request, const ChainPlan& plan) {
  const Request own{request.cloud, request.outputs, request.options, plan};
  require_own_files(own);
  PartPlan made;
  made.rows = plan_ranges(request);
  Statistics statistics = first_counts(own, {});
  require_work(own);
  check_request(own, {statistics, nullptr});
  made.rounds = {{{{PartRoundKind::cut}}, PartJoin::pieces}, {{{PartRoundKind::gather}}}};
  made.nonfinite = Nonfinite::keep;
  made.scratch_bytes = piece_bytes(request);
  made.notes = statistics.warnings;
  return made;
}

}  // namespace

PartPlan plan_parts(const SharedRequest& given) {
  const auto& [tiles, chain, outputs, options] = given;
  const ChainPlan plan = plan_of(given);
  if (options.division.divides()) return plan_division(given, plan);
  InputCloud cloud = cropped_input(tiles, plan);
  require_divisible(plan, outputs, options);
  require_common_grid(cloud, plan, options);
  require_apart(cloud);
  const Request request{cloud, outputs, options, plan};
  require_own_files(request);
  Statistics statistics = first_counts(request, {});
  const RunReport report{statistics, nullptr};
  require_work(request);
  const OutputNames names = check_request(request, report);
  RunPlaces places(options, {});
  const Context context{cloud, outputs, options, plan, names, {}, places, report};
  OutputFiles().require_writable(context, {});
  PartPlan made;
  made.others = other_files(request, report);
  made.record = recorded_stages(plan);
  made.nonfinite = nonfinite_rule(cloud, outputs, options.nonfinite);
  if (made.nonfinite != Nonfinite::keep) made.rounds.push_back({{{PartRoundKind::look}}});
  for (const Phase& phase : phases_of(plan)) add_phase(plan, phase, made);
  for (const auto& reader : cloud.readers()) made.rows.push_back(reader->info().count);
  for (std::size_t p = 0; p < plan.passes.size(); ++p) {
    const std::uint64_t before = p == 0 ? 0 : plan.passes[p - 1].carried_bytes();
    const bool sweeps = plan.passes[p].kind == PassKind::sweep;
    std::uint64_t stored = sweeps ? plan.passes[p].travelling_bytes() + sizeof(Vec3) + sizeof(std::uint64_t) : 0;
    const Stage* const connecting = plan.passes[p].connecting_stage();
    if (connecting != nullptr && connecting->connects()->weighted()) stored += kGraphBytes;
    made.scratch_bytes = std::max(made.scratch_bytes, stored + before + plan.passes[p].carried_bytes());
  }
  made.notes = statistics.warnings;
  return made;
}

void join_tiles(Storage& scratch, const std::vector<std::string>& left, const std::vector<std::string>& paths,
                const std::string& key) {
  const TileCatalogue tiles = catalogue_of(scratch, left, paths);
  seal_bytes(scratch, key, encoded(tiles));
}

void join_values(const SharedRequest& request, const PartRound& round, Storage& scratch, const std::string& before,
                 const std::vector<std::string>& left, const std::string& key) {
  CloudValues values = before.empty() ? CloudValues() : sealed_values(scratch, before);
  std::vector<std::vector<std::vector<std::byte>>> saved;
  for (const std::string& name : left) saved.push_back(TileState::left(scratch, name).saved_values);
  finish_values(plan_of(request).passes.at(round.steps.back().pass), saved, values);
  seal_values(scratch, key, values);
}

void join_graph(const SharedRequest& request, const PartRound& round, Storage& scratch, const JoinedBefore& before,
                const std::vector<std::string>& left, const std::string& key) {
  const ChainPlan plan = plan_of(request);
  const ConnectOperator& op = *plan.passes.at(round.steps.back().pass).connecting_stage()->connects();
  RunPlaces places(request.options, {});
  const TileGraphSetup setup{
      op.votes(), places.scratch(), &places.folder(), memory_budget(request.options.resources.memory_bytes) / 2, {}};
  const auto tiles = sealed_value<TileCatalogue>(scratch, before.catalogue);
  if (round.join == PartJoin::borders)
    find_borders(scratch, tiles, left, setup, key);
  else if (op.weighted())
    join_forests(scratch, left, before.borders, setup, key);
  else
    join_graphs(scratch, tiles, left, setup, key);
}

void forget(Storage& scratch, const std::string& left) {
  for (const char* const end : kLeftByTasks) scratch.remove(left + end);
}

}  // namespace pointsweep
