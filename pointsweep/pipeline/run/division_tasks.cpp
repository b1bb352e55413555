// SPDX-License-Identifier: MIT
/// The tasks of a run on many machines that divides its points among files, their plan and their join (part_run.h).
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/formats/cloud/reader_adapters.h"
#include "pointsweep/formats/files/folders.h"
#include "pointsweep/order/source.h"
#include "pointsweep/part/record_list.h"
#include "pointsweep/pipeline/memory/run_memory.h"
#include "pointsweep/pipeline/output/divided_writer.h"
#include "pointsweep/pipeline/output/output_warnings.h"
#include "pointsweep/pipeline/rows/nonfinite_points.h"
#include "pointsweep/pipeline/run/output_files.h"
#include "pointsweep/pipeline/run/part_run.h"
#include "pointsweep/pipeline/run/phases.h"
#include "pointsweep/pipeline/run/request.h"
#include "pointsweep/pipeline/run/task_values.h"
#include "pointsweep/pipeline/statistics.h"
#include "pointsweep/row_error.h"
#include "pointsweep/storage/storage.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kBytesOfPiece = 1 << 20;

/// The least number of rows of a range, unless kRangesOfFiles asks for more ranges, and the largest number of ranges.
/// They bound the time that all tasks together spend on opening all inputs: 0.1 ms for each input and task, while the
/// work on a range takes seconds.
constexpr std::uint64_t kRowsOfRange = 4'000'000, kMostRanges = 256;
/// A cloud has at least as many ranges as input files, up to this number.
constexpr std::uint64_t kRangesOfFiles = 16;

/// A request with all decisions that precede the work of a task.
class DivisionRun {
 public:
  explicit DivisionRun(const SharedRequest& given)
      : plan_(plan_of(given)),
        request_{given.cloud, given.outputs, given.options, plan_},
        statistics_(first_counts(request_, {})),
        names_(check_request(request_, {unsaid_, nullptr})),
        places_(given.options, {}) {
    statistics_.warnings.clear();  // plan_parts() has returned these warnings
    Surveyed nothing;
    work_.emplace(plan_work(context_, nothing));
    copy_.emplace(plan_copy(context_, *work_));
    divider_.emplace(copy_->output, given.options.division);
  }

  const Context& context() const { return context_; }
  const Divider& divider() const { return *divider_; }
  const OutputLayout& layout() const { return *work_->layout; }
  std::uint64_t division_bytes() const { return copy_->division_bytes; }
  unsigned threads() const { return work_->memory.threads; }
  Statistics statistics() {
    statistics_.peak_rss_bytes = peak_resident_bytes();
    return std::move(statistics_);
  }

 private:
  ChainPlan plan_;
  Request request_;
  Statistics statistics_, unsaid_;
  OutputNames names_;
  RunPlaces places_;
  NonfiniteRows dropped_;
  RunReport report_{statistics_, request_.options.observer};
  Context context_{request_.cloud,
                   request_.outputs,
                   request_.options,
                   plan_,
                   names_,
                   dropped_,
                   places_,
                   report_,
                   open_input_bytes(request_.cloud),
                   true};
  std::optional<WorkPlan> work_;
  std::optional<CopyPlan> copy_;
  std::optional<Divider> divider_;
};

/// Performs work(run) on the threads that the run has planned.
template <class Work>
void with_run(const SharedRequest& request, const Work& work) {
  const EngineOptions& options = request.options;
  const CancellationScope scope(options.observer != nullptr ? &options.observer->token() : nullptr);
  with_threads(survey_threads(request.cloud, options), [&] {
    DivisionRun run(request);
    with_threads(run.threads(), [&] { work(run); });
  });
}

/// Reads the rows of a range, converts them to output records, and adds these to `records`.
void divide_rows(const DivisionRun& run, RowRange range, DividedRecords& records) {
  const Context& context = run.context();
  const OutputLayout& layout = run.layout();
  const std::size_t before = context.cloud.schema().stride, after = layout.schema().stride;
  const std::uint64_t at_once = std::max<std::uint64_t>(1, (4 << 20) / std::max<std::size_t>(after, 1));
  FloatRounding rounding(context.cloud.schema(), {}, layout.schema());
  ParallelRows rows(context.cloud_source());
  std::vector<std::byte> inputs, outputs;
  for (std::uint64_t done = 0; done < range.rows;) {
    stop_if_cancelled();
    const std::uint64_t n = std::min(at_once, range.rows - done);
    inputs.resize(n * before), outputs.resize(n * after);
    rows.read(range.first + done, inputs);
    layout.assemble_all(inputs.data(), nullptr, n, outputs.data(), range.first + done);
    rounding.see(outputs);
    records.write(outputs);
    done += n;
    context.progress("writing", done);
  }
  if (const std::string sentence = rounding.sentence(); !sentence.empty())
    context.report.warn(fmt::format("{}: {}", folder_of(context.outputs.points).string(), sentence));
}

/// Passes the records of a file on to `use`, from the pieces of all ranges.
template <class Use>
void read_file(const Storage& scratch, const FilesOfRanges& all, std::size_t file, std::size_t record_bytes,
               std::vector<std::unique_ptr<RecordList>>& lists, const Use& use) {
  const std::uint64_t at_once = std::max<std::uint64_t>(1, kBytesOfPiece / record_bytes);
  std::vector<std::byte> records;
  for (const PieceOfFile& piece : all.pieces[file]) {
    std::unique_ptr<RecordList>& list = lists[piece.range];
    if (!list) list = std::make_unique<RecordList>(scratch, all.ranges[piece.range] + ".pieces", record_bytes);
    for (std::uint64_t done = 0; done < piece.count;) {
      stop_if_cancelled();
      records.resize(std::min(at_once, piece.count - done) * record_bytes);
      list->read(piece.first + done, records);
      use(records);
      done += records.size() / record_bytes;
    }
  }
}

}  // namespace

ChainPlan plan_of(const SharedRequest& request) {
  return plan_chain(request.chain, request.cloud.schema(), needs_of(request.outputs, request.options));
}

std::vector<std::uint64_t> plan_ranges(const SharedRequest& request) {
  const ChainPlan plan = plan_of(request);
  if (!request.chain.stages.empty())
    fail_usage(
        "Many processes divide points that no stage changes: let them run the stages into a folder of tiles first, or "
        "run it in one process, without a client or --dask.");
  const bool may_lack_places = std::ranges::any_of(request.cloud.readers(), [](const auto& reader) {
    return can_be_nonfinite(reader->info().schema, reader->info().path);
  });
  if (may_lack_places && nonfinite_rule(request.cloud, request.outputs, request.options.nonfinite) != Nonfinite::keep)
    fail_usage(
        "Which points have no place is known when all are read, and each process reads some: name outputs that hold "
        "such points, e.g. PLY, or run it in one process, without a client or --dask.");
  EngineOptions of_one_thread = request.options;  // a worker may have fewer threads than this process
  of_one_thread.resources.threads = 1;
  if (!copies_rows({request.cloud, request.outputs, of_one_thread, plan}))
    fail_usage(
        "The layout of the outputs depends on all points, and each process reads some: leave out --scale, --offset and "
        "--order, name outputs of the format of the inputs, or run it in one process, without a client or --dask.");
  const std::uint64_t rows = request.cloud.count();
  const std::uint64_t files = std::min<std::uint64_t>(request.cloud.readers().size(), kRangesOfFiles);
  const std::uint64_t ranges = std::clamp(rows / kRowsOfRange, files, kMostRanges);
  std::vector<std::uint64_t> counts;
  for (std::uint64_t r = 0; r < ranges; ++r) counts.push_back((r + 1) * rows / ranges - r * rows / ranges);
  return counts;
}

std::uint64_t piece_bytes(const SharedRequest& request) {
  MadeFolders folders;
  folders.make_for(request.outputs.points);
  const DivisionRun run(request);
  run.divider().require_writable();
  return run.divider().plan().schema.stride;
}

Statistics cut_range(const SharedRequest& request, RowRange range, Storage& scratch, const std::string& name) {
  Statistics statistics;
  with_run(request, [&](DivisionRun& run) {
    DividedRecords records(run.divider(), range.rows, run.division_bytes() / 2, run.context().places.scratch());
    try {
      divide_rows(run, range, records);
    } catch (const RowError& error) {
      throw Error(run.context().located(error).what());
    }
    request.cloud.require_unchanged();
    RecordListWriter list(scratch, name + ".pieces", run.divider().plan().schema.stride);
    records.for_each([&](std::uint32_t, std::span<const std::byte> of_file) { list.append(of_file); });
    list.seal();
    const PiecesOfRange pieces{records.files()};
    seal_bytes(scratch, name + ".cut", encoded(pieces));
    statistics = run.statistics();
  });
  return statistics;
}

void join_pieces(const SharedRequest& request, Storage& scratch, const std::vector<std::string>& names,
                 const std::string& key) {
  std::vector<PiecesOfRange> pieces;
  for (const std::string& name : names) pieces.push_back(sealed_value<PiecesOfRange>(scratch, name + ".cut"));
  const FilesOfRanges joined = files_of(names, pieces);
  MadeFolders folders;
  folders.make_for(request.outputs.points);
  const DivisionRun run(request);
  run.divider().require_few(files_with_points(joined.files));
  require_files_possible(run.divider(), joined.files);
  seal_bytes(scratch, key, encoded(joined));
}

Statistics write_pieces(const SharedRequest& request, std::size_t task, std::size_t tasks, const Storage& scratch,
                        const std::string& key) {
  const auto all = sealed_value<FilesOfRanges>(scratch, key);
  const std::vector<std::size_t> numbers = all.of_task(task, tasks);
  Statistics statistics;
  if (numbers.empty()) return statistics;
  with_run(request, [&](DivisionRun& run) {
    std::vector<DividedFile> own;
    std::uint64_t own_points = 0;
    for (const std::size_t number : numbers) {
      own.push_back(all.files[number]);
      own_points += all.files[number].own;
    }
    MadeFolders folders;
    folders.make_for(request.outputs.points);
    const auto progress = [&](double share) {
      run.context().progress("completing", static_cast<std::uint64_t>(share * static_cast<double>(own_points)));
    };
    DividedFiles files(run.divider(), own, run.division_bytes(), progress);
    std::vector<std::unique_ptr<RecordList>> lists(all.ranges.size());
    for (std::uint32_t i = 0; i < own.size(); ++i)
      read_file(scratch, all, numbers[i], run.divider().plan().schema.stride, lists,
                [&](std::span<const std::byte> records) { files.take(i, records); });
    files.finish();
    statistics = run.statistics();
    statistics.points_written = own_points;
    statistics.bytes_written = files.bytes_written();
    statistics.files_written = files.complete();
    for (const std::string& sentence : files.warnings()) statistics.warnings.push_back(sentence);
  });
  return statistics;
}

}  // namespace pointsweep
