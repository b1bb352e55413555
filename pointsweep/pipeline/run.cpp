// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cstring>
#include <thread>

#include "pointsweep/error.h"
#include "pointsweep/order/row_store.h"
#include "pointsweep/order/stream.h"
#include "pointsweep/order/temp_folder.h"
#include "pointsweep/pipeline/demand.h"
#include "pointsweep/pipeline/memory_plan.h"
#include "pointsweep/pipeline/output_set.h"
#include "pointsweep/pipeline/pipeline.h"
#include "pointsweep/pipeline/result_sinks.h"
#include "pointsweep/pipeline/slab_order.h"
#include "pointsweep/sweep/sweep.h"
#include "pointsweep/threads.h"

namespace pointsweep {

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// One run from survey to finished files; the members live through all its phases.
class Run {
 public:
  Run(Cloud& cloud, const RunOptions& options) : cloud_(cloud), options_(options) {
    statistics_.points = cloud.count();
    statistics_.threads = options.threads != 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
    statistics_.memory_budget_bytes = options.memory_bytes != 0 ? options.memory_bytes : default_memory_budget();
    statistics_.machine = machine_description();
    if (cloud.count() == 0) fail("{}: has no points, so there is nothing to do.", name_of_cloud());
    for (const auto& reader : cloud.readers()) {
      const auto& warnings = reader->info().warnings;
      statistics_.warnings.insert(statistics_.warnings.end(), warnings.begin(), warnings.end());
    }
  }

  Statistics operators(const Chain& chain, const Outputs& outputs) {
    if (options_.order == Order::sweep && !outputs.arrays.empty()) {
      fail_usage("Arrays have their rows in input order: leave out --order sweep.");
    }
    PlannedChain planned = plan_chain(chain, cloud_.schema());
    note_neighborhood(chain);
    survey_cloud(options_.order == Order::sweep || needs_bounds(outputs.points));
    OutputSet files(cloud_, planned.made, outputs, options_.overwrite, bounds_if_exact());
    const bool whole = options_.order == Order::sweep;
    const MemoryPlan memory =
        plan_memory_for(planned.plan, whole ? files.layout().schema().stride : planned.plan.result_bytes, whole,
                        planned.payload(cloud_.schema()).size());
    order(memory, whole, planned.payload(cloud_.schema()));
    planned.bind(stream_->record_schema());
    sweep_into(files, planned, memory, whole);
    files.finish();
    statistics_.bytes_written = files.bytes_written();
    return finish(planned.plan);
  }

  Statistics sorted(const std::filesystem::path& output) {
    survey_cloud(true);
    OutputSet files(cloud_, {}, {.points = output, .arrays = {}, .writer = {}}, options_.overwrite, bounds_if_exact());
    const MemoryPlan memory = plan_memory_for(
        {.neighborhood = {}, .stages = {}, .steps = {0, 0}, .column_bytes = {}, .file_columns = {}, .results = {}}, 0,
        true, 0);
    order(memory, true, {});
    const auto start = Clock::now();
    write_sorted(files);
    files.finish();
    statistics_.write_seconds = seconds_since(start);
    statistics_.bytes_written = files.bytes_written();
    return finish({});
  }

 private:
  std::string name_of_cloud() const {
    return cloud_.readers().empty() ? "The input" : cloud_.readers().front()->info().path.string();
  }

  /// A format that stores integers must know the bounds before the first record, unless the input is of that format.
  bool needs_bounds(const std::filesystem::path& output) const {
    return output.extension() == ".las" || output.extension() == ".LAS";
  }
  std::optional<Box> bounds_if_exact() const {
    return survey_.exact && !survey_.bounds.empty() ? std::optional(survey_.bounds) : std::nullopt;
  }

  void note_neighborhood(const Chain& chain) {
    const bool limited = chain.neighborhood.k != Neighborhood::kUnlimited;
    statistics_.k = limited ? chain.neighborhood.k : 0;
    if (limited && chain.neighborhood.k >= cloud_.count()) {
      statistics_.warnings.push_back(
          fmt::format("k = {} is more than the {} other points there are: neighbourhoods hold all of them.",
                      chain.neighborhood.k, cloud_.count() - 1));
    }
  }

  void survey_cloud(bool exact) {
    source_ = {cloud_.schema(), cloud_.count(), [this](std::uint64_t row, std::span<std::byte> records) {
                 const std::size_t n = cloud_.read(row, records);
                 statistics_.bytes_read += n * cloud_.schema().stride;
                 return n;
               }};
    started_ = Clock::now();
    survey_ = survey(source_, options_.axis, exact);
  }

  MemoryPlan plan_memory_for(const SweepPlan& plan, std::uint64_t result_bytes, bool whole, std::size_t payload) const {
    MemoryPlan memory = plan_memory(statistics_.memory_budget_bytes, plan,
                                    memory_demand(cloud_, survey_, options_, whole, payload, result_bytes));
    if (options_.spill) {
      memory.spill_stream = memory.spill_results = true;
      memory.result_buffer_bytes = std::max<std::uint64_t>(memory.result_buffer_bytes, 1 << 20);
    }
    return memory;
  }

  void order(const MemoryPlan& memory, bool whole, const std::vector<std::size_t>& payload) {
    if (memory.spill_stream || memory.spill_results) {
      folder_.emplace(options_.temp_folder.empty() ? std::filesystem::temp_directory_path() : options_.temp_folder);
    }
    stream_.emplace(source_, survey_,
                    StreamOptions{.axis = survey_.axis,
                                  .slab_points = memory.slab_points,
                                  .max_slab_points = 0,
                                  .whole_records = whole,
                                  .payload = payload,
                                  .spill = memory.spill_stream ? &*folder_ : nullptr,
                                  .buffer_bytes = memory.stream_buffer_bytes,
                                  .progress = [this](std::uint64_t rows) { report("ordering", rows, 0); }});
    survey_.sample = {};
    statistics_.nonfinite = stream_->nonfinite_count();
    statistics_.order_seconds = seconds_since(started_);
  }

  void sweep_into(OutputSet& files, const PlannedChain& planned, const MemoryPlan& memory, bool whole) {
    const std::uint32_t stride = whole ? files.layout().schema().stride : planned.plan.result_bytes;
    RowStore store(cloud_.count(), stride, std::byte{0}, memory.spill_results ? &*folder_ : nullptr,
                   memory.result_buffer_bytes);
    const std::uint32_t input_stride = cloud_.schema().stride;
    InputOrderSink by_row(store, stride);
    SweepOrderSink by_place(store, *stream_, files.layout(), input_stride);
    SweepOptions sweep_options{
        .cell_points = options_.cell_points,
        .read_ahead = std::max(1u, statistics_.threads / 2),
        .recall_bytes = memory.recall_bytes,
        .progress = [this](std::uint64_t read, std::uint64_t active) { report("sweeping", read, active); }};
    sweep_statistics_ = sweep(*stream_, planned.plan, whole ? static_cast<Sink&>(by_place) : by_row, sweep_options);
    put_nonfinite(store, planned, whole ? &files.layout() : nullptr);
    statistics_.bytes_spilled = stream_->spilled_bytes();
    if (!whole) stream_.reset();  // nothing is read from it any more
    const auto start = Clock::now();
    store.drain([&](std::uint64_t first, std::span<const std::byte> records) {
      whole ? files.write_records(records) : files.write_results(cloud_, first, records);
      report("writing", first + records.size() / std::max<std::size_t>(stride, 1), 0);
    });
    statistics_.bytes_spilled += store.spilled_bytes();
    statistics_.write_seconds = seconds_since(start);
  }

  /// Points without a place in space keep their attributes and get the values that stand for none.
  void put_nonfinite(RowStore& store, const PlannedChain& planned, const OutputLayout* layout) {
    std::vector<std::byte> none = value_of_none(planned);
    for_each_nonfinite([&](std::uint64_t i, const std::byte* record, std::uint64_t row) {
      stay_in_place(planned, record, none);
      if (layout == nullptr) return store.put({&row, 1}, none);
      std::vector<std::byte> output(layout->schema().stride);
      layout->assemble(record, none.data(), 1, output.data());
      const std::uint64_t place = cloud_.count() - stream_->nonfinite_count() + i;
      store.put({&place, 1}, output);
    });
  }

  static std::vector<std::byte> value_of_none(const PlannedChain& planned) {
    std::vector<std::byte> none;
    for (const Attribute& a : planned.made) none.insert(none.end(), a.bytes(), a.fill);
    return none;
  }

  /// Nobody moves such a point.
  void stay_in_place(const PlannedChain& planned, const std::byte* record, std::vector<std::byte>& none) const {
    std::size_t offset = 0;
    for (const Attribute& a : planned.made) {
      if (a.name == position_attribute().name) {
        const PositionFields p = position_fields(stream_->record_schema(), "the working record");
        const double position[3] = {value_of(p.x, record), value_of(p.y, record), value_of(p.z, record)};
        std::memcpy(none.data() + offset, position, sizeof position);
      }
      offset += a.bytes();
    }
  }

  template <class Use>
  void for_each_nonfinite(Use use) {
    const Schema& schema = stream_->record_schema();
    const Field& row_field = schema.fields.back();
    const std::uint64_t n = stream_->nonfinite_count(), chunk = 65536;
    std::vector<std::byte> records;
    for (std::uint64_t first = 0; first < n; first += chunk) {
      const std::uint64_t count = std::min(chunk, n - first);
      records.resize(count * schema.stride);
      stream_->read_nonfinite(first, records);
      for (std::uint64_t i = 0; i < count; ++i) {
        const std::byte* record = records.data() + i * schema.stride;
        std::uint64_t row = 0;
        std::memcpy(&row, record + row_field.offset, size_of(row_field.type));
        use(first + i, record, row);
      }
    }
  }

  void write_sorted(OutputSet& files) {
    const std::size_t from = stream_->record_schema().stride, to = cloud_.schema().stride;
    std::vector<std::byte> records, sorted;
    std::uint64_t done = 0;
    for (std::size_t s = 0; s < stream_->slabs().size(); ++s) {
      records.resize(stream_->slabs()[s].count * from);
      stream_->read(s, records);
      const std::vector<std::uint32_t> order = order_of(*stream_, records);
      sorted.resize(order.size() * to);
      for (std::size_t i = 0; i < order.size(); ++i) {
        std::memcpy(sorted.data() + i * to, records.data() + order[i] * from, to);
      }
      files.write_records(sorted);
      report("writing", done += order.size(), 0);
    }
    for_each_nonfinite([&](std::uint64_t, const std::byte* record, std::uint64_t) {
      files.write_records({record, to});
    });
    statistics_.bytes_spilled = stream_->spilled_bytes();
  }

  void report(const char* phase, std::uint64_t done, std::uint64_t active) const {
    if (options_.progress) options_.progress({phase, done, cloud_.count(), active});
  }

  Statistics finish(const SweepPlan& plan) {
    const SweepStatistics& s = sweep_statistics_;
    statistics_.certified = s.certified, statistics_.recalled = s.recalled, statistics_.degenerate = s.degenerate;
    statistics_.read_seconds = s.read_seconds, statistics_.search_seconds = s.search_seconds;
    for (std::size_t i = 0; i < plan.stages.size(); ++i) {
      statistics_.operator_seconds.emplace_back(plan.stages[i].op->name(), s.stage_seconds[i]);
    }
    statistics_.peak_points = s.peak_points, statistics_.mean_points = s.mean_points, statistics_.series = s.series;
    statistics_.lifespan_mean_seconds = s.lifespan_mean, statistics_.lifespan_max_seconds = s.lifespan_max;
    statistics_.total_seconds = seconds_since(started_);
    statistics_.peak_rss_bytes = peak_resident_bytes();
    return std::move(statistics_);
  }

  Cloud& cloud_;
  const RunOptions& options_;
  Statistics statistics_;
  PointSource source_;
  Survey survey_;
  std::optional<TempFolder> folder_;
  std::optional<Stream> stream_;
  SweepStatistics sweep_statistics_;
  Clock::time_point started_;
};

/// Runs on as many threads as asked for, however many the caller's arena has.
template <class Work>
Statistics on_threads(const RunOptions& options, Work work) {
  const unsigned threads = options.threads != 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
  Statistics statistics;
  with_threads(threads, [&] { statistics = work(); });
  return statistics;
}

}  // namespace

Statistics run(Cloud& cloud, const Chain& chain, const Outputs& outputs, const RunOptions& options) {
  return on_threads(options, [&] { return Run(cloud, options).operators(chain, outputs); });
}

Statistics sort(Cloud& cloud, const std::filesystem::path& output, const RunOptions& options) {
  return on_threads(options, [&] { return Run(cloud, options).sorted(output); });
}

}  // namespace pointsweep
