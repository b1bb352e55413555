// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <set>
#include <thread>

#include "pointsweep/cancellation.h"
#include "pointsweep/error.h"
#include "pointsweep/formats/files/same_file.h"
#include "pointsweep/formats/known_values.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/order/row_store.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/order/temp_folder.h"
#include "pointsweep/order/working_record.h"
#include "pointsweep/pipeline/canonical_text.h"
#include "pointsweep/pipeline/checkpoints.h"
#include "pointsweep/pipeline/finite_input.h"
#include "pointsweep/pipeline/nonfinite_points.h"
#include "pointsweep/pipeline/observation.h"
#include "pointsweep/pipeline/ordered_output.h"
#include "pointsweep/pipeline/output_names.h"
#include "pointsweep/pipeline/output_set.h"
#include "pointsweep/pipeline/pass_update.h"
#include "pointsweep/pipeline/pass_values.h"
#include "pointsweep/pipeline/pipeline.h"
#include "pointsweep/pipeline/planned_sweeps.h"
#include "pointsweep/pipeline/provenance_record.h"
#include "pointsweep/pipeline/radius_estimate.h"
#include "pointsweep/pipeline/reference_run.h"
#include "pointsweep/pipeline/result_sinks.h"
#include "pointsweep/pipeline/row_mask.h"
#include "pointsweep/pipeline/row_pass.h"
#include "pointsweep/pipeline/run_identity.h"
#include "pointsweep/pipeline/run_memory.h"
#include "pointsweep/pipeline/updated_cloud.h"
#include "pointsweep/sweep/sweep.h"
#include "pointsweep/threads.h"

namespace pointsweep {

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// One run from survey to finished files; the members live through all its phases.
class Run {
 public:
  Run(Cloud& cloud, const Outputs& outputs, const RunOptions& options)
      : cloud_(cloud),
        outputs_(with_own_files(cloud, outputs, options)),
        options_(options),
        started_(Clock::now()),
        input_(cloud, outputs, options) {
    statistics_.points = statistics_.points_written = cloud.count();
    statistics_.threads = options.threads != 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
    statistics_.memory_budget_bytes = options.memory_bytes != 0 ? options.memory_bytes : default_memory_budget();
    statistics_.machine = machine_description();
    if (!options.temp_folder.empty()) require_temp_parent(options.temp_folder);
    if (cloud.count() == 0) fail("{}: has no points, so there is nothing to do.", name_of_cloud());
    for (const auto& reader : cloud.readers()) {
      const auto& warnings = reader->info().warnings;
      statistics_.warnings.insert(statistics_.warnings.end(), warnings.begin(), warnings.end());
    }
    statistics_.warnings.insert(statistics_.warnings.end(), cloud.warnings().begin(), cloud.warnings().end());
    statistics_.dropped = statistics_.nonfinite = input_.dropped().count;
    statistics_.nonfinite_rows = input_.dropped().rows;
    warn(input_.warning());
  }

  Statistics operators(const Chain& chain) {
    const bool in_stream_order = options_.order == Order::sweep;
    if (in_stream_order && !outputs_.arrays.empty()) {
      fail_usage("Arrays have their rows in input order: leave out --order sweep.");
    }
    PlannedSweeps planned = plan_sweeps(chain, cloud_.schema(), in_stream_order);
    const OutputNames names = named(planned);
    warn(names.warning());
    if (by_reference()) require_reference_can(options_);
    note_neighborhoods(planned);
    open_checkpoints(planned, canonical_stages(chain, Presets::spelled_out));
    survey_cloud(in_stream_order || by_reference() || needs_bounds() || planned.sweeps.front().kind == PassKind::order);
    require_distances(survey_.bounds);
    const OutputLayout layout(cloud_.schema(), names.made, names.kept,
                              type_of_moved_positions(cloud_.schema(), outputs_.points, options_));
    const RunMemory memory = plan_run_memory(statistics_.memory_budget_bytes, planned, cloud_.count(), survey_,
                                             options_, layout.schema().stride);
    open_files_ = [&] {
      files_.emplace(cloud_, names.made, names.kept, outputs_, options_, bounds_if_known(),
                     provenance(canonical_stages(chain, Presets::left_out), chain, planned.kept), values_if_needed());
    };
    planned.selects() ? require_writable(names) : open_files_();
    give_notice(memory);
    make_folder(memory.spills());
    const std::size_t begin = first_pass(planned);
    for (std::size_t s = begin; s < planned.sweeps.size() && cloud_.count() > 0; ++s)
      run_pass(s, planned, memory, layout);
    if (planned.reorders && cloud_.count() > 0) write_reordered(planned, memory.reordering, layout);
    if (!files_) write_rows(planned);
    return finish();
  }

  Statistics sorted(const std::vector<std::string>& keep) {
    PlannedSweeps planned;
    if (!keep.empty()) planned.kept = kept_fields(keep, {}, cloud_.schema());
    open_checkpoints(planned, kSort);
    survey_cloud(true);
    Chain kept;
    kept.keep = keep;
    files_.emplace(cloud_, std::vector<Attribute>{}, planned.kept, outputs_, options_, bounds_if_known(),
                   provenance(kSort, kept, planned.kept), values_if_needed());
    const MemoryPlan memory = plan_ordering_memory(statistics_.memory_budget_bytes, cloud_.schema().stride,
                                                   cloud_.count(), survey_, options_);
    if (memory.needed_bytes != 0) fail_budget(statistics_.memory_budget_bytes, memory.needed_bytes);
    make_folder(memory.spill_stream);
    order(0, memory, true, {});
    if (checkpoints_) checkpoints_->in_order(*stream_, memory.slab_points, nullptr);
    write_stream(cloud_.schema().stride, [&](std::span<const std::byte> inputs) { files_->write_inputs(inputs); });
    return finish();
  }

 private:
  inline static const std::vector<std::string> kSort = {"sort"};  ///< the stages of sort()

  void give_notice(const RunMemory& memory) const {
    double seconds = 0, neighbors = 0;
    for (const Effort& effort : memory.efforts) {
      seconds += effort.seconds;
      neighbors = std::max(neighbors, effort.neighbors_per_point);
    }
    constexpr double kWorthSaying = 60;
    if (options_.notice && seconds >= kWorthSaying)
      options_.notice(fmt::format("The radius means {}; a smaller one, or k beside it, takes less.",
                                  effort_text(neighbors, seconds)));
  }

  std::string name_of_cloud() const {
    return cloud_.readers().empty() ? "The input" : cloud_.readers().front()->info().path.string();
  }

  /// Throws UsageError where an output is an input or another output.
  static const Outputs& with_own_files(const Cloud& cloud, const Outputs& outputs, const RunOptions& options) {
    std::vector<std::filesystem::path> read, written = {outputs.points, options.half_way_states};
    for (std::size_t i = 0; i < cloud.readers().size(); ++i)
      if (cloud.states()[i].is_known()) read.push_back(cloud.readers()[i]->info().path);
    for (const auto& [name, path] : outputs.arrays) written.push_back(path);
    require_separate_files(read, written);
    return outputs;
  }

  void warn(const std::string& sentence) {
    if (!sentence.empty()) statistics_.warnings.push_back(sentence);
  }

  /// Whether an attribute is not written because of Chain::keep.
  static bool leaves_out(const Chain& chain, const KeptFields& kept) {
    std::set<std::string> made;
    for (const auto& op : chain.operators)
      if (const Contract contract = op->contract(); contract.selects == Selects::nothing)
        for (const Attribute& a : contract.makes) made.insert(a.name);
    return kept.input || !kept.left_out.empty() || kept.attributes.size() < made.size();
  }

  OutputNames named(const PlannedSweeps& planned) const {
    if (outputs_.points.empty() && !outputs_.writer) return {planned.made, planned.kept, {}};
    return name_outputs(cloud_.schema(), name_of_cloud(), planned.made, planned.kept, outputs_.points,
                        {options_.prefix, options_.replace});
  }

  std::vector<std::string> provenance(const std::vector<std::string>& stages, const Chain& chain,
                                      const KeptFields& kept) const {
    return provenance_of(cloud_, stages, leaves_out(chain, kept) ? chain.keep : std::vector<std::string>{}, options_,
                         survey_.axis, statistics_.dropped > 0);
  }

  /// The reference then reads points in canonical order, whatever order the output has: its search depends on it, and
  /// where it is not exact, its results depend on the axis, too.
  bool by_reference() const { return options_.engine == Engine::reference; }

  /// A format that stores integers must know the bounds before the first record, unless these integers come.
  bool needs_bounds() const {
    const Format* const format = format_of_output(outputs_.points);
    return format != nullptr && format->needs_bounds != nullptr &&
           (input_.dropped().bounds.empty() || cloud_.selection()) && format->needs_bounds(cloud_.schema());
  }
  /// That the files can be written is known before the work, what is in their headers after the last select.
  void require_writable(const OutputNames& names) const {
    Box somewhere = survey_.bounds;
    if (somewhere.empty()) somewhere.include(Vec3{});
    OutputSet(cloud_, names.made, names.kept, outputs_, options_, somewhere);
  }
  /// The files of a run that has left out rows. `survey_` is that of the order of the output, if it has one.
  void open_late() {
    if (needs_bounds() && cloud_.count() > 0) {
      source_ = cloud_source();
      const int axis = survey_.axis;
      look(true);
      survey_.axis = axis;
    }
    statistics_.points_written = cloud_.count();
    if (cloud_.count() == 0) warn(fmt::format("No point is left: {} holds none.", outputs_.points.string()));
    open_files_();
  }
  /// What the format of the output has to know of all values before the first record.
  std::shared_ptr<const KnownValues> values_if_needed() {
    const Format* const format = format_of_output(outputs_.points);
    if (format == nullptr || format->values == nullptr) return nullptr;
    return std::make_shared<KnownValues>(
        format->values(cloud_, [this](std::uint64_t rows) { report("ordering", rows, 0); }));
  }
  std::optional<Box> bounds_if_known() const {
    if (const Box& box = input_.dropped().bounds; !box.empty() && !cloud_.selection()) return box;
    if (cloud_.count() == 0) return Box{Vec3{}, Vec3{}};
    return survey_.exact && !survey_.bounds.empty() ? std::optional(survey_.bounds) : std::nullopt;
  }

  void note_neighborhoods(const PlannedSweeps& planned) {
    std::set<std::size_t> noted;
    for (const PlannedSweep& sweep : planned.sweeps) {
      if (sweep.kind != PassKind::sweep) continue;
      const std::size_t k = sweep.chain.plan.neighborhood.k;
      const bool limited = k != Neighborhood::kUnlimited;
      if (noted.empty()) statistics_.k = limited ? k : 0;
      if (!noted.insert(k).second || !limited || k < cloud_.count()) continue;
      statistics_.warnings.push_back(
          fmt::format("k = {} is more than the {} other points there are: neighbourhoods hold all of them.", k,
                      cloud_.count() - 1));
    }
  }

  void open_checkpoints(const PlannedSweeps& planned, const std::vector<std::string>& stages) {
    if (options_.resume_folder.empty()) return;
    if (by_reference() || !options_.half_way_states.empty())
      fail_usage("A run of the reference engine, or one that notes half-way states, cannot be resumed.");
    checkpoints_.emplace(options_, run_identity(cloud_, stages, planned, outputs_, options_));
    if (!checkpoints_->found()) return;
    take_counts(statistics_, checkpoints_->last().counts);
    statistics_.warnings.push_back(
        "Went on where an earlier process had ended: times and series are of this one alone.");
  }

  void make_folder(bool spills) {
    if (!spills || checkpoints_) return;
    folder_.emplace(options_.temp_folder.empty() ? std::filesystem::temp_directory_path() : options_.temp_folder);
  }
  SpillPlace place(const char* kind, std::size_t sweep, bool spills) const {
    if (checkpoints_) return checkpoints_->place(kind, sweep);
    return spills ? &*folder_ : nullptr;
  }

  PointSource cloud_source() {
    return {cloud_.schema(), cloud_.count(), [this](std::uint64_t row, std::span<std::byte> records) {
              const std::size_t n = cloud_.read(row, records);
              statistics_.bytes_read += n * cloud_.schema().stride;
              return n;
            }};
  }
  void survey_cloud(bool exact) {
    source_ = cloud_source();
    if (checkpoints_ && checkpoints_->found()) return void(survey_ = checkpoints_->last().survey);
    look(exact);
    if (checkpoints_) checkpoints_->surveyed(survey_);
  }
  void look(bool exact) {
    const auto start = Clock::now();
    survey_ = survey(source_, options_.axis, exact);
    statistics_.order_seconds += seconds_since(start);
  }

  void order(std::size_t s, const MemoryPlan& memory, bool whole, const std::vector<std::size_t>& payload,
             bool canonical = false) {
    canonical = canonical || whole || by_reference();
    const bool is_in_order = checkpoints_ && checkpoints_->last().is_in_order();
    if (s > 0 && !is_in_order) look(canonical);
    const auto start = Clock::now();
    const StreamOptions options{.axis = survey_.axis,
                                .slab_points = memory.slab_points,
                                .max_slab_points = 0,
                                .canonical = canonical,
                                .whole_records = whole,
                                .payload = payload,
                                .spill = place("stream", s, memory.spill_stream),
                                .buffer_bytes = memory.stream_buffer_bytes,
                                .progress = [this](std::uint64_t rows) { report("ordering", rows, 0); }};
    if (is_in_order) {
      checkpoints_->require_slabs_of(memory.slab_points);
      Unpacker packed(checkpoints_->last().stream);
      stream_.emplace(packed, source_, options);
    } else {
      stream_.emplace(source_, survey_, options);
    }
    survey_.sample = {};
    note_nonfinite();
    statistics_.order_seconds += seconds_since(start);
  }

  /// Numbers of rows of the cloud before any select.
  std::vector<std::uint64_t> rows_of_cloud(std::vector<std::uint64_t> rows) const {
    if (const RowSelection* selection = cloud_.selection())
      for (std::uint64_t& row : rows) row = selection->row_of(row);
    return rows;
  }

  void note_nonfinite() {
    if (statistics_.nonfinite_rows.empty() && stream_->nonfinite_count() > 0)
      statistics_.nonfinite_rows = rows_of_cloud(first_nonfinite_rows(*stream_, NonfiniteRows::kMostListed));
    statistics_.nonfinite = std::max(statistics_.nonfinite, statistics_.dropped + stream_->nonfinite_count());
  }

  /// One pass, from the rows as they are (pass 0: the input) to the rows as it leaves them, or to the files.
  void run_pass(std::size_t s, PlannedSweeps& planned, const RunMemory& memory, const OutputLayout& layout) {
    PlannedSweep& pass = planned.sweeps[s];
    if (s > 0) source_ = updated_source(cloud_, *rows_, pass, [this](std::uint64_t n) { statistics_.bytes_read += n; });
    give_values(pass, values_);
    const bool whole = leaves_in_order(planned, options_) && s + 1 == planned.sweeps.size();
    std::unique_ptr<RowStore> results;
    if (pass.kind != PassKind::rows) results = results_of(s, planned, memory, whole ? &layout : nullptr);
    if (results && !(checkpoints_ && checkpoints_->last().is_swept()))
      fill(*results, s, planned, memory.sweeps[s], whole ? &layout : nullptr);
    const auto start = Clock::now();
    if (whole)
      write_whole(*results);
    else if (s + 1 < planned.sweeps.size() || planned.reorders || pass.selects)
      update(made_by(pass, results.get()), s, planned, memory.spill_rows);
    else
      write(made_by(pass, results.get()), s, planned);
    if (results) statistics_.bytes_spilled += results->spilled_bytes();
    statistics_.write_seconds += seconds_since(start);
  }

  /// Puts what the pass makes into `results`.
  void fill(RowStore& results, std::size_t s, PlannedSweeps& planned, const MemoryPlan& memory,
            const OutputLayout* whole) {
    PlannedSweep& pass = planned.sweeps[s];
    const bool by_order = pass.kind == PassKind::order;
    order(s, memory, whole != nullptr, pass.chain.payload(pass.input), by_order);
    if (checkpoints_) checkpoints_->in_order(*stream_, memory.slab_points, &results);
    pass.chain.bind(stream_->record_schema());
    by_order ? leave_out_equal(results) : sweep_into(results, pass.chain, memory, whole);
    statistics_.bytes_spilled += stream_->spilled_bytes();
    stream_.reset();  // nothing is read from it any more
    if (checkpoints_) checkpoints_->swept(results, statistics_);
  }

  /// What a pass has made, by row.
  MadeRows made_by(PlannedSweep& pass, RowStore* results) {
    if (results != nullptr) {
      return [results, bytes = pass.chain.plan.result_bytes](const auto& use) {
        results->drain([&](std::uint64_t first, std::span<const std::byte> made) {
          use(first, made.size() / bytes, made.data());
        });
      };
    }
    if (pass.chain.plan.stages.empty()) {  // it is there for the values that are found of its rows
      return [this](const auto& use) {
        constexpr std::uint64_t kRows = 1 << 16;
        for (std::uint64_t row = 0; row < cloud_.count(); row += kRows) {
          stop_if_cancelled();
          use(row, static_cast<std::size_t>(std::min(kRows, cloud_.count() - row)), nullptr);
        }
      };
    }
    return [this, &pass](const auto& use) {
      pass.chain.bind(pass.input);
      RowPass rows(pass);
      rows.run(source_, use);
      note_rows_pass(pass.chain.plan, rows.tally());
    };
  }

  void note_rows_pass(const SweepPlan& plan, const StageTally& tally) {
    const std::size_t before = statistics_.degenerate_results.size();
    for (std::size_t i = 0; i < plan.stages.size(); ++i) {
      const std::string name = plan.stages[i].op->name();
      statistics_.operator_seconds.emplace_back(name, tally.seconds[i]);
      statistics_.degenerate_results.push_back({name, tally.degenerate[i].count(), tally.degenerate[i].lowest()});
      statistics_.degenerate += tally.degenerate[i].count();
    }
    number_rows_from(before);
  }
  /// Gives the rows of the results from `first` on the numbers they had before any select.
  void number_rows_from(std::size_t first) {
    for (std::size_t r = first; r < statistics_.degenerate_results.size(); ++r)
      statistics_.degenerate_results[r].rows = rows_of_cloud(std::move(statistics_.degenerate_results[r].rows));
  }

  /// Of the points of the stream with equal coordinates, all but the first get 0; a row that gets nothing is kept.
  void leave_out_equal(RowStore& results) {
    const Schema& schema = stream_->record_schema();
    const PositionFields fields = position_fields(schema, "the stream");
    std::optional<Vec3> last;
    std::vector<std::uint64_t> equal;
    const auto compare = [&](std::span<const std::byte> records) {
      equal.clear();
      for (std::size_t at = 0; at < records.size(); at += schema.stride) {
        const std::byte* record = records.data() + at;
        const Vec3 p{value_of(fields.x, record), value_of(fields.y, record), value_of(fields.z, record)};
        if (last && p == *last) equal.push_back(row_of(schema, record));
        last = p;
      }
      results.put(equal, std::vector<std::byte>(equal.size()));
    };
    write_in_order(*stream_, schema.stride, compare, [this](std::uint64_t done) { report("updating", done, 0); });
  }

  std::unique_ptr<RowStore> results_of(std::size_t s, const PlannedSweeps& planned, const RunMemory& memory,
                                       const OutputLayout* whole) const {
    const MemoryPlan& plan = memory.sweeps[s];
    const PlannedSweep& pass = planned.sweeps[s];
    const std::size_t bytes = whole != nullptr ? whole->schema().stride : pass.chain.plan.result_bytes;
    const std::byte fill = pass.kind == PassKind::order ? selection_attribute().fill : std::byte{0};
    const SpillPlace spill = place("results", s, plan.spill_results);
    const std::uint64_t rows = cloud_.count(), buffer = plan.result_buffer_bytes;
    if (!checkpoints_ || checkpoints_->last().results.empty())
      return std::make_unique<RowStore>(rows, bytes, fill, spill, buffer);
    Unpacker packed(checkpoints_->last().results);
    return std::make_unique<RowStore>(packed, rows, bytes, fill, spill, buffer);
  }

  /// Into `results` go result records by row, or, with a layout, output records by place in the stream.
  void sweep_into(RowStore& results, const PlannedChain& planned, const MemoryPlan& memory, const OutputLayout* whole) {
    const std::size_t before = statistics_.degenerate_results.size();
    if (by_reference()) {
      add_sweep(statistics_, planned.plan, sweep_by_reference(results, planned, memory, whole));
    } else {
      add_sweep(statistics_, planned.plan, sweep_by_cells(results, planned, memory, whole));
    }
    number_rows_from(before);
    put_nonfinite(results, planned, whole);
  }

  SweepStatistics sweep_by_cells(RowStore& results, const PlannedChain& planned, const MemoryPlan& memory,
                                 const OutputLayout* whole) {
    InputOrderSink by_row(results, planned.plan.result_bytes);
    std::optional<SweepOrderSink> by_place;
    if (whole != nullptr) by_place.emplace(results, *stream_, *whole, cloud_.schema().stride);
    const bool first = statistics_.sweeps == 0;
    std::vector<PointState> half_way(first && !options_.half_way_states.empty() ? cloud_.count() : 0);
    std::optional<CheckpointKeeper> keeper;
    std::optional<SweepProgress> from;
    if (checkpoints_) keeper.emplace(*checkpoints_, results), from = checkpoints_->progress();
    const SweepOptions sweep_options{
        .cell_points = options_.cell_points,
        .read_ahead = std::max(1u, statistics_.threads / 2),
        .recall_bytes = memory.recall_bytes,
        .cells_bytes = options_.search_again ? 0 : memory.cells_bytes,
        .lists_bytes = options_.lists_bytes != 0 ? options_.lists_bytes : memory.lists_bytes,
        .count_distances = first && options_.count_distances,
        .half_way = half_way.empty() ? nullptr : &half_way,
        .keeper = keeper ? &*keeper : nullptr,
        .resume_from = from ? &*from : nullptr,
        .progress = sweep_progress()};
    SweepStatistics done =
        sweep(*stream_, planned.plan, by_place ? static_cast<Sink&>(*by_place) : by_row, sweep_options);
    if (!half_way.empty()) write_states(half_way, options_.half_way_states, options_.overwrite);
    return done;
  }

  SweepStatistics sweep_by_reference(RowStore& results, const PlannedChain& planned, const MemoryPlan& memory,
                                     const OutputLayout* whole) {
    const std::uint64_t others = memory.expected_bytes - memory.window_bytes;
    const std::uint64_t budget = statistics_.memory_budget_bytes;
    if (!statistics_.reference) statistics_.reference.emplace();
    return run_reference({.stream = *stream_,
                          .planned = planned,
                          .store = results,
                          .layout = whole,
                          .memory_bytes = budget - std::min(budget, others),
                          .progress = sweep_progress()},
                         *statistics_.reference);
  }

  std::function<void(std::uint64_t, std::uint64_t)> sweep_progress() const {
    return [this](std::uint64_t read, std::uint64_t active) { report("sweeping", read, active); };
  }

  void put_nonfinite(RowStore& results, const PlannedChain& planned, const OutputLayout* whole) {
    NonfiniteResult none(planned.made, stream_->record_schema());
    for_each_nonfinite(*stream_, [&](std::uint64_t i, const std::byte* record, std::uint64_t row) {
      if (whole == nullptr) return results.put({&row, 1}, none.of(record));
      std::vector<std::byte> output(whole->schema().stride);
      whole->assemble(record, none.of(record).data(), 1, output.data());
      const std::uint64_t place = cloud_.count() - stream_->nonfinite_count() + i;
      results.put({&place, 1}, output);
    });
  }

  static RowUpdate update_after(std::size_t s, const PlannedSweeps& planned) {
    const std::vector<Attribute> none;
    const PlannedSweep& sweep = planned.sweeps[s];
    return {s == 0 ? none : planned.sweeps[s - 1].carried, sweep.chain.made, sweep.carried};
  }

  void update(const MadeRows& made, std::size_t s, const PlannedSweeps& planned, bool spills) {
    const PlannedSweep& pass = planned.sweeps[s];
    const RowUpdate after = update_after(s, planned);
    PassUpdate to(pass, cloud_, after.record_bytes(), place("rows", s + 1, spills), place("mask", s + 1, spills));
    update_rows(made, rows_.get(), after, pass.chain.plan.result_bytes, [&](const UpdatedRows& rows) {
      statistics_.bytes_read += to.add(rows);
      report("updating", rows.first + rows.count, 0);
    });
    rows_ = to.finish(values_);
    statistics_.bytes_spilled += to.spilled_bytes();
    if (checkpoints_) checkpoints_->updated(pass.selects, values_, statistics_);
  }

  /// The pass to begin with. The rows carried into it are there.
  std::size_t first_pass(const PlannedSweeps& planned) {
    if (!checkpoints_ || checkpoints_->last().sweep == 0) return 0;
    const Checkpoint& last = checkpoints_->last();
    const std::uint64_t s = last.sweep;
    if (last.mask > 0) cloud_.select(RowMask::kept(cloud_.count(), checkpoints_->place("mask", last.mask)));
    for (std::size_t v = 0; v < last.values.size(); ++v)
      if (!last.values[v].empty()) values_[v] = last.values[v];
    const std::size_t bytes = update_after(s - 1, planned).record_bytes();
    rows_ = std::make_unique<RowFile>(RowFile::kept(cloud_.count(), bytes, checkpoints_->place("rows", s)));
    source_ = cloud_source();
    return s;
  }

  /// Whole output records, in the order of the stream.
  void write_whole(RowStore& results) {
    if (!files_) open_late();
    const std::size_t stride = files_->layout().schema().stride;
    results.drain([&](std::uint64_t first, std::span<const std::byte> records) {
      files_->write_records(records);
      report("writing", first + records.size() / stride, 0);
    });
  }

  /// What the last pass makes, while it is made or behind it.
  void write(const MadeRows& made, std::size_t s, const PlannedSweeps& planned) {
    if (!files_) open_late();
    const auto use = [&](std::uint64_t first, std::size_t n, const std::byte* records, std::size_t bytes) {
      files_->write_results(cloud_, first, {records, n * bytes});
      report("writing", first + n, 0);
    };
    const std::size_t bytes = planned.sweeps[s].chain.plan.result_bytes;
    if (s == 0)
      return made([&](std::uint64_t first, std::size_t n, const std::byte* records) { use(first, n, records, bytes); });
    const RowUpdate after = update_after(s, planned);
    update_rows(made, rows_.get(), after, bytes,
                [&](const UpdatedRows& rows) { use(rows.first, rows.count, rows.after, after.record_bytes()); });
  }

  /// The rows that the last pass has left.
  void write_rows(const PlannedSweeps& planned) {
    const auto start = Clock::now();
    open_late();
    std::size_t bytes = 0;
    for (const Attribute& a : planned.made) bytes += a.bytes();
    const std::size_t stride = bytes != 0 ? bytes : cloud_.schema().stride;
    const std::uint64_t chunk = std::max<std::size_t>(1, (std::size_t{4} << 20) / stride);
    std::vector<std::byte> records;
    for (std::uint64_t first = 0; first < cloud_.count(); first += chunk) {
      stop_if_cancelled();
      records.resize(std::min(chunk, cloud_.count() - first) * stride);
      if (bytes != 0) {
        rows_->read(first, records);
        files_->write_results(cloud_, first, records);
      } else {
        read_fully(cloud_source(), first, records);
        files_->write_inputs(records);
      }
      report("writing", first + records.size() / stride, 0);
    }
    statistics_.write_seconds += seconds_since(start);
  }

  void write_reordered(const PlannedSweeps& planned, const MemoryPlan& memory, const OutputLayout& layout) {
    Reordering reordering(cloud_, *rows_, layout, planned.by_moved_positions);
    source_ = reordering.positions();
    look(true);
    if (!files_) open_late();
    source_ = reordering.records();
    order(0, memory, true, {});
    write_stream(layout.schema().stride, [&](std::span<const std::byte> records) { files_->write_records(records); });
  }

  void write_stream(std::size_t bytes, const std::function<void(std::span<const std::byte>)>& write_records) {
    const auto start = Clock::now();
    write_in_order(*stream_, bytes, write_records, [this](std::uint64_t done) { report("writing", done, 0); });
    statistics_.bytes_spilled += stream_->spilled_bytes();
    statistics_.write_seconds += seconds_since(start);
  }

  void report(const char* phase, std::uint64_t done, std::uint64_t active) const {
    if (options_.progress) options_.progress({phase, done, cloud_.count(), active});
  }

  Statistics finish() {
    for (const std::string& warning : files_->warnings()) statistics_.warnings.push_back(warning);
    files_->finish(cloud_);
    if (checkpoints_) checkpoints_->finish();
    number_degenerate_rows();
    statistics_.bytes_written = files_->bytes_written();
    statistics_.total_seconds = seconds_since(started_);
    statistics_.peak_rss_bytes = peak_resident_bytes();
    return std::move(statistics_);
  }

  /// As they are numbered in the input, whose nonfinite points may have been dropped.
  void number_degenerate_rows() {
    for (DegenerateResults& results : statistics_.degenerate_results)
      for (std::uint64_t& row : results.rows) row = cloud_.input_row(row);
  }

  Cloud& cloud_;
  const Outputs& outputs_;
  const RunOptions& options_;
  Clock::time_point started_;
  FiniteInput input_;  ///< made before the rows of the cloud are counted
  Statistics statistics_;
  PointSource source_;
  Survey survey_;
  std::optional<TempFolder> folder_;
  std::optional<Checkpoints> checkpoints_;
  std::unique_ptr<RowFile> rows_;  ///< what the pass before has left
  CloudValues values_;             ///< that are known by now
  std::function<void()> open_files_;
  std::optional<OutputSet> files_;  ///< opened before the work, or after the last select
  std::optional<Stream> stream_;
};

/// Runs on as many threads as asked for, however many the caller's arena has.
template <class Work>
Statistics on_threads(const RunOptions& options, Work work) {
  const unsigned threads = options.threads != 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
  const CancellationScope scope(options.cancellation);
  Statistics statistics;
  with_threads(threads, [&] { statistics = work(); });
  return statistics;
}

}  // namespace

Statistics run(Cloud& cloud, const Chain& chain, const Outputs& outputs, const RunOptions& options) {
  return on_threads(options, [&] { return Run(cloud, outputs, options).operators(chain); });
}

Statistics sort(Cloud& cloud, const std::filesystem::path& output, const RunOptions& options,
                const std::vector<std::string>& keep) {
  const Outputs outputs{.points = output, .arrays = {}, .writer = {}};
  return on_threads(options, [&] { return Run(cloud, outputs, options).sorted(keep); });
}

}  // namespace pointsweep
