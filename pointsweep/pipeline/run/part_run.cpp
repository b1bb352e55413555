// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/run/part_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/free_memory.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/order/working_record.h"
#include "pointsweep/part/needed_points.h"
#include "pointsweep/part/part_stream.h"
#include "pointsweep/part/record_list.h"
#include "pointsweep/part/tile_forest.h"
#include "pointsweep/part/tile_graph.h"
#include "pointsweep/pipeline/memory/run_memory.h"
#include "pointsweep/pipeline/rows/in_order_pass.h"
#include "pointsweep/pipeline/rows/input_source.h"
#include "pointsweep/pipeline/rows/nonfinite_points.h"
#include "pointsweep/pipeline/rows/other_cloud.h"
#include "pointsweep/pipeline/rows/pass_update.h"
#include "pointsweep/pipeline/run/output_files.h"
#include "pointsweep/pipeline/run/phases.h"
#include "pointsweep/pipeline/run/request.h"
#include "pointsweep/pipeline/run/task_values.h"
#include "pointsweep/pipeline/statistics.h"
#include "pointsweep/row_error.h"
#include "pointsweep/storage/local/unfinished_output.h"
#include "pointsweep/storage/storage.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::size_t kBytesAtOnce = 4 << 20;

/// Returns the schema of the records in which a file of another cloud is stored: positions, the fields of `reads`, and
/// the row.
Schema working_of_other(const InputCloud& file, const std::vector<Attribute>& reads) {
  std::vector<std::size_t> fields;
  for (const Attribute& a : reads) fields.push_back(file.schema().find(a.name).value());
  return WorkingRecord(file.schema(), false, fields, file.count()).schema();
}

/// Performs a task of kind PartRoundKind::other: stores one file of the other cloud that a pass reads.
PartDone store_other(const ChainPlan& plan, const EngineOptions& options, const PartTask& task, Storage& scratch) {
  const InOrderOperator& op = *plan.passes.at(task.round.pass()).in_order();
  InputCloud file({task.other_file});
  PartDone done;
  done.rows = file.count();
  if (file.count() == 0) {
    store_no_points(scratch, task.after);
    return done;
  }
  RunPlaces places(options, {});
  const auto progress = [&](std::uint64_t rows) {
    if (options.observer != nullptr) options.observer->on_progress({"ordering", rows, file.count(), 0});
  };
  const PointSource source = source_of(file);
  const int axis = survey(source, std::nullopt, false).axis;
  const Stream stream = OtherCloud::in_order(file, task.other_file, op.other_reads(), axis, &places.folder(), progress);
  file.require_unchanged();
  store_tile(stream, Survey{}, file.count(), scratch, task.after);
  return done;
}

/// Performs the steps of a task over one tile.
class TaskOfTile {
 public:
  TaskOfTile(const Context& context, const PartTask& task, Storage& scratch)
      : whole_(context), task_(task), scratch_(scratch), rows_{.cloud = std::make_shared<InputCloud>(context.cloud)} {}

  PartDone perform() {
    try {
      TileState state = restore();
      if (state.survey.sample.empty() && !is_empty()) state.survey = survey_input(context());
      Surveyed surveyed{state.survey, {}};
      WorkPlan work = plan_work(context(), surveyed);
      with_threads(work.memory.threads, [&] { perform(state, surveyed, work); });
    } catch (const RowError& error) {
      const std::uint64_t row = whole_.cloud.place_of_row(context().rows_of_cloud({error.row()}).front()).second;
      throw Error(
          error.named(fmt::format("{} of {}", row, whole_.cloud.readers().front()->info().path.string())).what());
    }
    done_.rows = rows_.cloud->count();
    return std::move(done_);
  }

 private:
  /// Returns the context over the rows of the tile that no pass so far has dropped.
  Context context() const { return whole_.over(*rows_.cloud); }
  bool is_empty() const { return rows_.cloud->count() == 0; }

  /// Performs the steps of the round. A step that stores points in order, a graph or a forest seals the state of the
  /// tile and ends the round. A step that writes the output ends the run of the tile. After any other last step, the
  /// state is sealed here.
  void perform(TileState& state, Surveyed& surveyed, WorkPlan& work) {
    const std::vector<PartStep>& steps = task_.round.steps;
    const bool leaves_graph = task_.round.join == PartJoin::components || task_.round.join == PartJoin::borders;
    for (std::size_t s = 0; s < steps.size(); ++s) {
      stop_if_cancelled();
      const auto [kind, p] = steps[s];
      if (kind == PartRoundKind::order) return order(p, state, surveyed, work);
      if (kind == PartRoundKind::forest) return grow_forest(p, state, work);
      std::unique_ptr<RowStore> results;  // null for passes over rows, and for tiles without rows
      if (kind == PartRoundKind::sweep && !is_empty()) results = sweep(p, surveyed.survey, work);
      if (leaves_graph) return keep_swept(p, state, results.get());
      if (kind == PartRoundKind::label && !is_empty()) results = label(p, state, work);
      if (kind == PartRoundKind::write || !whole_.plan.leaves_rows(p))
        return write(p, surveyed.survey, work, results.get());
      end_pass(p, state, work, std::move(results));
      const bool is_last = s + 1 == steps.size();
      if (is_last || steps[s + 1].kind == PartRoundKind::order) keep_rows(state);
    }
    state.seal(scratch_, task_.after);
  }

  void write(std::size_t p, const Survey& of_input, WorkPlan& work, RowStore* results) {
    OutputFiles files;
    files.open(context(), work, of_input, rows_);  // only checks the outputs if they open late
    if (whole_.plan.opens_late()) files.open_late(context(), work, of_input, rows_);
    write_output(context(), work, p, rows_, nullptr, results, files);
    files.finish(context());
  }

  void end_pass(std::size_t p, TileState& state, WorkPlan& work, std::unique_ptr<RowStore> results) {
    if (is_empty()) {
      state.saved_values = PassValues(whole_.plan.passes[p], rows_.cloud->schema()).save();
      return;
    }
    const Context context = this->context();
    Rows before = std::exchange(rows_, {.cloud = rows_.cloud});
    rows_ = update_pass(context, work, p, std::move(before), std::move(results));
    state.saved_values = std::move(rows_.saved_values);
  }

  /// Ends a task whose sweep has stored a graph: stores the results of the sweep, and seals the state of the tile,
  /// which names this task. For a tile without rows, stores empty lists instead of results.
  void keep_swept(std::size_t p, TileState& state, RowStore* results) {
    const PlannedPass& pass = whole_.plan.passes[p];
    const ConnectOperator& op = *pass.connecting_stage()->connects();
    if (results != nullptr) {
      RecordListWriter list(scratch_, task_.after + ".results", pass.plan.result_bytes);
      results->drain([&](std::uint64_t, std::span<const std::byte> records) { list.append(records); });
      list.seal();
    } else if (op.weighted()) {
      RecordListWriter(scratch_, task_.after + ".crossings", sizeof(ForestEdge)).seal();
    } else {
      leave_no_graph(op.votes(), scratch_, task_.after);
    }
    state.swept = task_.after;
    state.seal(scratch_, task_.after);
  }

  void grow_forest(std::size_t p, const TileState& state, const WorkPlan& work) {
    if (!is_empty()) {
      const auto tiles = shared_catalogue(scratch_, task_.catalogue);
      const RowsOfTile rows{tiles->tiles.at(task_.tile).first_row, rows_.cloud->count()};
      const TileGraphSetup setup{whole_.plan.passes[p].connecting_stage()->connects()->votes(), whole_.places.scratch(),
                                 &whole_.places.folder(), work.memory.passes[p].recall_bytes / 2,
                                 context().progress_of("connecting")};
      leave_forest(scratch_, state.swept, task_.borders + "-" + std::to_string(task_.tile), rows, setup, task_.after);
    } else {
      leave_no_forest(scratch_, task_.after);
    }
    state.seal(scratch_, task_.after);
  }

  std::unique_ptr<RowStore> label(std::size_t p, const TileState& state, const WorkPlan& work) {
    const PlannedPass& pass = whole_.plan.passes[p];
    std::unique_ptr<RowStore> results = results_of_pass(context(), work, work.memory.passes[p], p);
    RecordList swept(scratch_, state.swept + ".results", pass.plan.result_bytes);
    label_points(context(), pass, work.memory.passes[p], {{&scratch_, task_.before}, task_.components, swept},
                 *results);
    return results;
  }

  /// Restores the state in which the previous task has left the tile: its selected rows and their carried records.
  TileState restore() {
    TileState state;
    if (!task_.values.empty()) rows_.values = sealed_values(scratch_, task_.values);
    if (task_.before.empty()) return state;
    state = TileState::left(scratch_, task_.before);
    InputCloud& cloud = *rows_.cloud;
    if (!state.mask.empty()) {
      if (state.mask.size() != (cloud.count() + RowSelection::kBlockRows - 1) / RowSelection::kBlockRows)
        fail("{}: has changed since the run began.", cloud.readers().front()->info().path.string());
      const auto mask = std::make_shared<std::vector<std::vector<std::byte>>>(state.mask);
      cloud = cloud.selected({cloud.count(), [mask](std::uint64_t block, std::span<std::byte> bits) {
                                std::ranges::copy((*mask)[block], bits.begin());
                              }});
    }
    if (!state.carried.empty()) rows_.carried = carried_rows(state.carried);
    return state;
  }

  std::unique_ptr<RowFile> carried_rows(const std::string& name) {
    std::size_t last = task_.round.pass();  // the pass that begins with the records
    if (task_.round.kind() == PartRoundKind::write) last = whole_.plan.passes.size();
    const std::size_t bytes = whole_.plan.passes[last - 1].carried_bytes();
    const auto list = std::make_shared<const RecordList>(scratch_, name + ".rows", bytes);
    if (list->count() != rows_.cloud->count()) fail("{}.rows: is damaged.", name);
    return std::make_unique<RowFile>(
        list->count(), bytes, [list](std::uint64_t row, std::span<std::byte> records) { list->read(row, records); });
  }

  /// Stores the records that the pass carries to the next task, and notes in `state` which rows are left.
  void keep_rows(TileState& state) {
    state.carried.clear();
    if (rows_.carried && rows_.carried->record_bytes() > 0) {
      const std::size_t bytes = rows_.carried->record_bytes();
      RecordListWriter list(scratch_, task_.after + ".rows", bytes);
      const std::uint64_t count = rows_.cloud->count(), at_once = std::max<std::size_t>(1, kBytesAtOnce / bytes);
      std::vector<std::byte> records;
      for (std::uint64_t row = 0; row < count; row += at_once) {
        stop_if_cancelled();
        records.resize(std::min(at_once, count - row) * bytes);
        rows_.carried->read(row, records);
        list.append(records);
      }
      list.seal();
      state.carried = task_.after;
    }
    if (const auto& selection = rows_.cloud->selection()) {
      SelectionCursor kept(*selection);
      state.mask.assign((selection->rows() + RowSelection::kBlockRows - 1) / RowSelection::kBlockRows,
                        std::vector<std::byte>(RowSelection::kBlockBytes));
      for (std::uint64_t row = 0; row < selection->rows(); ++row)
        if (kept.has(row))
          state.mask[row / RowSelection::kBlockRows][row % RowSelection::kBlockRows / 8] |= std::byte{1} << row % 8;
    }
  }

  void order(std::size_t p, TileState& state, Surveyed& surveyed, WorkPlan& work) {
    if (!is_empty()) {
      OutputFiles files;
      const Ordered ordered =
          order_pass(context(), work, p, rows_, {surveyed.survey, std::move(surveyed.boxes)}, files);
      return_free_memory_above(work.spare_bytes());
      store_tile(ordered.stream, ordered.survey, rows_.cloud->count(), scratch_, task_.after,
                 chosen_for_others(p, ordered.stream));
      done_.own_points = rows_.cloud->count() - ordered.stream.nonfinite_count();
    } else {
      store_no_points(scratch_, task_.after);
    }
    state.saved_values.clear();
    state.seal(scratch_, task_.after);
  }

  /// Returns the function that chooses the points that other tiles need; empty if other tiles need all points.
  ChooseForOthers chosen_for_others(std::size_t p, const Stream& stream) const {
    const PlannedPass& pass = whole_.plan.passes[p];
    const InOrderOperator* const op = pass.in_order();
    const InOrderOperator::ChoosePoints choose = op != nullptr ? op->for_other_parts() : nullptr;
    if (!choose) return {};
    return [choose, &pass, &stream](std::span<const std::byte> records) {
      return for_other_parts(choose, pass, stream.record_schema(), records);
    };
  }

  std::unique_ptr<RowStore> sweep(std::size_t p, const Survey& of_input, WorkPlan& work) {
    const PlannedPass& pass = whole_.plan.passes[p];
    const std::shared_ptr<const TileCatalogue> catalogue = shared_catalogue(scratch_, task_.catalogue);
    const TileCatalogue& tiles = *catalogue;
    const Schema working =
        WorkingRecord(source_of_pass(context(), p, rows_).schema, false, pass.payload(), rows_.cloud->count()).schema();
    if (pass.kind == PassKind::order) return take_in_order(p, of_input, work, tiles, working);
    PartStream part = part_stream(scratch_, tiles, task_.tile, working, pass.plan.neighborhood, pass.plan.step_count());
    plan_memory(of_input, work, part.own_points, part.swept_points);
    auto ordered = std::make_unique<Ordered>(
        Ordered{std::move(part.stream), {}, std::move(part.survey), work.memory.passes[p], part.first_row});
    return sweep_pass(context(), work, p, std::move(ordered), rows_.values,
                      PassSupport{.graph = {&scratch_, task_.after}});
  }

  std::unique_ptr<RowStore> take_in_order(std::size_t p, const Survey& of_input, WorkPlan& work,
                                          const TileCatalogue& tiles, const Schema& working) {
    const InOrderOperator& op = *whole_.plan.passes[p].in_order();
    for (Reach reach = *op.reach();; reach.distance *= 2) {
      const NeededPoints needed = needed_points(scratch_, tiles, task_.tile, working, op, reach);
      plan_memory(of_input, work, needed.own_points, needed.points);
      auto ordered =
          std::make_unique<Ordered>(order_numbered(context(), work, p, needed.source, of_input, needed.first_row));
      const auto other = [&](int axis, const auto& take) { give_other(op, tiles, axis, take); };
      std::uint64_t undecided = 0;
      std::unique_ptr<RowStore> results = sweep_pass(context(), work, p, std::move(ordered), rows_.values,
                                                     PassSupport{other, needed.may_lack, &undecided});
      if (undecided == 0) return results;
    }
  }

  void give_other(const InOrderOperator& op, const TileCatalogue& tiles, int axis,
                  const std::function<void(const OtherPoints&)>& take) {
    const std::shared_ptr<const TileCatalogue> others = shared_catalogue(scratch_, task_.other_catalogue);
    const Schema working = working_of_other(InputCloud({task_.other_file}), op.other_reads());
    const NeededPoints needed = needed_of_other(scratch_, tiles, task_.tile, *others, working, op);
    const Stream stream = OtherCloud::in_order(needed.source, axis, &whole_.places.folder());
    OtherCloud::give(stream, task_.other_file, op.other_reads(), context().progress_of("ordering"), take);
  }

  /// Plans the memory again for a sweep of `points` points, of which `own_points` lie in the tile.
  void plan_memory(const Survey& of_input, WorkPlan& work, std::uint64_t own_points, std::uint64_t points) {
    done_.own_points = own_points;
    done_.swept_points = points;
    const EngineOptions& options = whole_.options;
    const std::uint64_t record = work.layout->schema().stride;
    const auto codecs = [&](unsigned threads) { return whole_.codec_bytes(record, threads); };
    work.memory = plan_run_memory(work.budget, whole_.plan, std::max(points, rows_.cloud->count()), of_input, options,
                                  record, codecs);
  }

  const Context& whole_;
  const PartTask& task_;
  Storage& scratch_;
  Rows rows_;
  PartDone done_;
};

}  // namespace

PartDone run_part(const SharedRequest& given, const PartTask& task, Storage& scratch) {
  const Outputs& outputs = given.outputs;
  EngineOptions options = given.options;
  options.ordering = Ordering::distribution;
  options.overwrite = true;
  const SharedRequest shared{given.cloud, given.chain, outputs, options};
  if (task.round.kind() == PartRoundKind::cut)
    return {.statistics = cut_range(shared, {task.first_row, task.rows}, scratch, task.after)};
  if (task.round.kind() == PartRoundKind::gather)
    return {.statistics = write_pieces(shared, task.tile, task.tiles, scratch, task.pieces)};
  const CancellationScope scope(options.observer != nullptr ? &options.observer->token() : nullptr);
  const ChainPlan plan = plan_of(shared);
  if (task.round.kind() == PartRoundKind::other) return store_other(plan, options, task, scratch);
  auto [tile, dropped] = finite_input(input_of_chain(given.cloud, plan, task.first_row), outputs, options);
  if (task.round.kind() == PartRoundKind::look) {
    PartDone done;
    done.statistics.dropped = dropped.count;
    return done;
  }
  const ManyOutputs listed = ManyOutputs::listed_by_caller(outputs.tiles);
  const Request request{tile, outputs, options, plan};
  Statistics statistics = first_counts(request, dropped);
  statistics.warnings.clear();  // plan_parts() has returned these warnings
  Statistics unsaid;
  const OutputNames names = check_request(request, {unsaid, nullptr});
  RunPlaces places(options, {});
  const RunReport report{statistics, options.observer};
  Context context{tile, outputs, options, plan, names, dropped, places, report, open_input_bytes(tile)};
  context.part = PartOfRun{task.tile, task.tiles, task.dropped > 0, task.record};
  PartDone done;
  with_threads(survey_threads(tile, options), [&] { done = TaskOfTile(context, task, scratch).perform(); });
  statistics.peak_rss_bytes = peak_resident_bytes();
  done.statistics = std::move(statistics);
  return done;
}

}  // namespace pointsweep
