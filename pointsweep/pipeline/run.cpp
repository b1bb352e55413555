// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <set>
#include <thread>

#include "pointsweep/cancellation.h"
#include "pointsweep/error.h"
#include "pointsweep/formats/extension.h"
#include "pointsweep/formats/las_layout.h"
#include "pointsweep/formats/las_values.h"
#include "pointsweep/formats/same_file.h"
#include "pointsweep/order/row_store.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/order/temp_folder.h"
#include "pointsweep/pipeline/canonical_text.h"
#include "pointsweep/pipeline/checkpoints.h"
#include "pointsweep/pipeline/finite_input.h"
#include "pointsweep/pipeline/nonfinite_points.h"
#include "pointsweep/pipeline/observation.h"
#include "pointsweep/pipeline/ordered_output.h"
#include "pointsweep/pipeline/output_names.h"
#include "pointsweep/pipeline/output_set.h"
#include "pointsweep/pipeline/pipeline.h"
#include "pointsweep/pipeline/planned_sweeps.h"
#include "pointsweep/pipeline/provenance_record.h"
#include "pointsweep/pipeline/radius_estimate.h"
#include "pointsweep/pipeline/reference_run.h"
#include "pointsweep/pipeline/result_sinks.h"
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
    statistics_.points = cloud.count();
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
    survey_cloud(in_stream_order || by_reference() || needs_bounds());
    require_distances(survey_.bounds);
    OutputSet files(cloud_, names.made, names.kept, outputs_, options_, bounds_if_known(),
                    provenance(canonical_stages(chain, Presets::left_out), chain, planned.kept), values_if_las());
    const RunMemory memory = plan_run_memory(statistics_.memory_budget_bytes, planned, cloud_.count(), survey_,
                                             options_, files.layout().schema().stride);
    give_notice(memory);
    make_folder(memory.spills());
    for (std::size_t s = first_sweep(planned); s < planned.sweeps.size(); ++s) sweep_once(s, planned, memory, files);
    if (planned.reorders) write_reordered(planned, memory.reordering, files);
    return finish(files);
  }

  Statistics sorted(const std::vector<std::string>& keep) {
    PlannedSweeps planned;
    if (!keep.empty()) planned.kept = kept_fields(keep, {}, cloud_.schema());
    open_checkpoints(planned, kSort);
    survey_cloud(true);
    Chain kept;
    kept.keep = keep;
    OutputSet files(cloud_, {}, planned.kept, outputs_, options_, bounds_if_known(),
                    provenance(kSort, kept, planned.kept), values_if_las());
    const MemoryPlan memory = plan_ordering_memory(statistics_.memory_budget_bytes, cloud_.schema().stride,
                                                   cloud_.count(), survey_, options_);
    if (memory.needed_bytes != 0) fail_budget(statistics_.memory_budget_bytes, memory.needed_bytes);
    make_folder(memory.spill_stream);
    order(0, memory, true, {});
    if (checkpoints_) checkpoints_->in_order(*stream_, memory.slab_points, nullptr);
    write_stream(cloud_.schema().stride, [&](std::span<const std::byte> inputs) { files.write_inputs(inputs); });
    return finish(files);
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
      for (const Attribute& a : op->contract().makes) made.insert(a.name);
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
    return extension_of(outputs_.points) == ".las" && input_.dropped().bounds.empty() &&
           !las_keeps_scale(position_fields(cloud_.schema(), name_of_cloud()));
  }
  /// What a LAS output has to know of all values before the first record.
  std::shared_ptr<const LasValues> values_if_las() {
    if (extension_of(outputs_.points) != ".las") return nullptr;
    return std::make_shared<LasValues>(las_values(cloud_, [this](std::uint64_t rows) { report("ordering", rows, 0); }));
  }
  std::optional<Box> bounds_if_known() const {
    if (const Box& box = input_.dropped().bounds; !box.empty()) return box;
    return survey_.exact && !survey_.bounds.empty() ? std::optional(survey_.bounds) : std::nullopt;
  }

  void note_neighborhoods(const PlannedSweeps& planned) {
    std::set<std::size_t> noted;
    for (const PlannedSweep& sweep : planned.sweeps) {
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

  void survey_cloud(bool exact) {
    source_ = {cloud_.schema(), cloud_.count(), [this](std::uint64_t row, std::span<std::byte> records) {
                 const std::size_t n = cloud_.read(row, records);
                 statistics_.bytes_read += n * cloud_.schema().stride;
                 return n;
               }};
    if (checkpoints_ && checkpoints_->found()) return void(survey_ = checkpoints_->last().survey);
    look(exact);
    if (checkpoints_) checkpoints_->surveyed(survey_);
  }
  void look(bool exact) {
    const auto start = Clock::now();
    survey_ = survey(source_, options_.axis, exact);
    statistics_.order_seconds += seconds_since(start);
  }

  void order(std::size_t s, const MemoryPlan& memory, bool whole, const std::vector<std::size_t>& payload) {
    const auto start = Clock::now();
    const StreamOptions options{.axis = survey_.axis,
                                .slab_points = memory.slab_points,
                                .max_slab_points = 0,
                                .canonical = whole || by_reference(),
                                .whole_records = whole,
                                .payload = payload,
                                .spill = place("stream", s, memory.spill_stream),
                                .buffer_bytes = memory.stream_buffer_bytes,
                                .progress = [this](std::uint64_t rows) { report("ordering", rows, 0); }};
    if (checkpoints_ && checkpoints_->last().is_in_order()) {
      checkpoints_->require_slabs_of(memory.slab_points);
      Unpacker packed(checkpoints_->last().stream);
      stream_.emplace(packed, source_, options);
    } else {
      if (s > 0) look(by_reference());
      stream_.emplace(source_, survey_, options);
    }
    survey_.sample = {};
    note_nonfinite();
    statistics_.order_seconds += seconds_since(start);
  }

  void note_nonfinite() {
    if (statistics_.nonfinite_rows.empty() && stream_->nonfinite_count() > 0)
      statistics_.nonfinite_rows = first_nonfinite_rows(*stream_, NonfiniteRows::kMostListed);
    statistics_.nonfinite = std::max(statistics_.nonfinite, statistics_.dropped + stream_->nonfinite_count());
  }

  /// One sweep, from the rows as they are (sweep 0: the input) to the rows as it leaves them, or to the files.
  void sweep_once(std::size_t s, PlannedSweeps& planned, const RunMemory& memory, OutputSet& files) {
    PlannedSweep& sweep = planned.sweeps[s];
    if (s > 0)
      source_ = updated_source(cloud_, *rows_, sweep, [this](std::uint64_t n) { statistics_.bytes_read += n; });
    const bool whole = leaves_in_order(planned, options_);
    const auto results = results_of(s, whole ? files.layout().schema().stride : sweep.chain.plan.result_bytes, memory);
    if (!checkpoints_ || !checkpoints_->last().is_swept()) {
      order(s, memory.sweeps[s], whole, sweep.chain.payload(sweep.input));
      if (checkpoints_) checkpoints_->in_order(*stream_, memory.sweeps[s].slab_points, results.get());
      sweep.chain.bind(stream_->record_schema());
      sweep_into(*results, sweep.chain, memory.sweeps[s], whole ? &files.layout() : nullptr);
      statistics_.bytes_spilled += stream_->spilled_bytes();
      stream_.reset();  // nothing is read from it any more
      if (checkpoints_) checkpoints_->swept(*results, statistics_);
    }
    const auto start = Clock::now();
    if (s + 1 < planned.sweeps.size() || planned.reorders)
      update(*results, s, planned, memory.spill_rows);
    else
      write(*results, s, planned, whole, files);
    statistics_.bytes_spilled += results->spilled_bytes();
    statistics_.write_seconds += seconds_since(start);
  }

  std::unique_ptr<RowStore> results_of(std::size_t s, std::size_t bytes, const RunMemory& memory) const {
    const MemoryPlan& plan = memory.sweeps[s];
    const SpillPlace spill = place("results", s, plan.spill_results);
    const std::uint64_t rows = cloud_.count(), buffer = plan.result_buffer_bytes;
    if (!checkpoints_ || checkpoints_->last().results.empty())
      return std::make_unique<RowStore>(rows, bytes, std::byte{0}, spill, buffer);
    Unpacker packed(checkpoints_->last().results);
    return std::make_unique<RowStore>(packed, rows, bytes, std::byte{0}, spill, buffer);
  }

  /// Into `results` go result records by row, or, with a layout, output records by place in the stream.
  void sweep_into(RowStore& results, const PlannedChain& planned, const MemoryPlan& memory, const OutputLayout* whole) {
    if (by_reference()) {
      add_sweep(statistics_, planned.plan, sweep_by_reference(results, planned, memory, whole));
    } else {
      add_sweep(statistics_, planned.plan, sweep_by_cells(results, planned, memory, whole));
    }
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

  void update(RowStore& results, std::size_t s, const PlannedSweeps& planned, bool spills) {
    const RowUpdate after = update_after(s, planned);
    auto updated = std::make_unique<RowFile>(cloud_.count(), after.record_bytes(), place("rows", s + 1, spills));
    update_rows(results, rows_.get(), after, planned.sweeps[s].chain.plan.result_bytes,
                [&](std::uint64_t first, std::span<const std::byte> records) {
                  updated->append(records);
                  report("updating", first + records.size() / updated->record_bytes(), 0);
                });
    statistics_.bytes_spilled += updated->spilled_bytes();
    rows_ = std::move(updated);
    if (checkpoints_) checkpoints_->updated();
  }

  /// The sweep to begin with. The rows carried into it are there.
  std::size_t first_sweep(const PlannedSweeps& planned) {
    const std::size_t s = checkpoints_ ? checkpoints_->last().sweep : 0;
    if (s > 0) {
      const std::size_t bytes = update_after(s - 1, planned).record_bytes();
      rows_ = std::make_unique<RowFile>(RowFile::kept(cloud_.count(), bytes, checkpoints_->place("rows", s)));
    }
    return s;
  }

  void write(RowStore& results, std::size_t s, const PlannedSweeps& planned, bool whole, OutputSet& files) {
    const std::size_t stride = whole ? files.layout().schema().stride : planned.sweeps[s].chain.plan.result_bytes;
    const auto use = [&](std::uint64_t first, std::span<const std::byte> records) {
      whole ? files.write_records(records) : files.write_results(cloud_, first, records);
    };
    if (s == 0) {
      results.drain([&](std::uint64_t first, std::span<const std::byte> records) {
        use(first, records);
        report("writing", first + records.size() / stride, 0);
      });
      return;
    }
    const RowUpdate after = update_after(s, planned);
    update_rows(results, rows_.get(), after, stride, [&](std::uint64_t first, std::span<const std::byte> records) {
      use(first, records);
      report("writing", first + records.size() / after.record_bytes(), 0);
    });
  }

  void write_reordered(const PlannedSweeps& planned, const MemoryPlan& memory, OutputSet& files) {
    Reordering reordering(cloud_, *rows_, files.layout(), planned.by_moved_positions);
    source_ = reordering.positions();
    look(true);
    source_ = reordering.records();
    order(0, memory, true, {});
    write_stream(files.layout().schema().stride,
                 [&](std::span<const std::byte> records) { files.write_records(records); });
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

  Statistics finish(OutputSet& files) {
    for (const std::string& warning : files.warnings()) statistics_.warnings.push_back(warning);
    files.finish(cloud_);
    if (checkpoints_) checkpoints_->finish();
    number_degenerate_rows();
    statistics_.bytes_written = files.bytes_written();
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
  std::unique_ptr<RowFile> rows_;  ///< what the sweep before has left
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
