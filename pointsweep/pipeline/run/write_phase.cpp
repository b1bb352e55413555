// SPDX-License-Identifier: MIT
/// The phase that writes the output: the results of the last pass, the rows that it leaves, or the records that an
/// order phase has sorted.
#include <algorithm>

#include "pointsweep/cancellation.h"
#include "pointsweep/order/source.h"
#include "pointsweep/pipeline/rows/ordered_output.h"
#include "pointsweep/pipeline/run/output_files.h"
#include "pointsweep/pipeline/run/phases.h"
#include "pointsweep/row_error.h"

namespace pointsweep {
namespace {

/// Writes whole output records in the order of the stream of the last pass.
void write_whole(const Context& context, RowStore& results, std::size_t stride, OutputFiles& files) {
  results.drain([&](std::uint64_t first, std::span<const std::byte> records) {
    with_rows_of_output([&] { files.write_records(records); });
    context.progress("writing", first + records.size() / stride);
  });
}

/// Writes the rows in order with all made attributes: those of pass `p`, and those carried from earlier passes. A pass
/// over rows is performed here; a sweep has left its results in `results`.
void write_made(const Context& context, std::size_t p, const Rows& rows, RowStore* results, OutputFiles& files) {
  const auto use = [&](std::uint64_t first, std::size_t n, const std::byte* records, std::size_t bytes) {
    files.write_results(context.cloud, first, {records, n * bytes});
    context.progress("writing", first + n);
  };
  const std::size_t bytes = context.plan.passes[p].plan.result_bytes;
  const MadeRows made = made_by_pass(context, p, rows, results);
  if (p == 0)
    return made([&](std::uint64_t first, std::size_t n, const std::byte* records) { use(first, n, records, bytes); });
  const RowUpdate after = update_after(context.plan, p);
  update_rows(made, rows.carried.get(), after, [&](const UpdatedRows& updated) {
    use(updated.first, updated.count, updated.after, after.record_bytes());
  });
}

/// Writes the rows that are left, with the carried attributes if the plan makes any: the rows after the last pass, or
/// all rows of a run that only copies.
void write_rows(const Context& context, const Rows& rows, OutputFiles& files) {
  const std::size_t bytes = bytes_of(context.plan.made);
  const std::size_t stride = bytes != 0 ? bytes : context.cloud.schema().stride;
  const std::uint64_t chunk = std::max<std::size_t>(1, (std::size_t{4} << 20) / stride), count = context.cloud.count();
  ParallelRows inputs(context.cloud_source());
  std::vector<std::byte> records;
  for (std::uint64_t first = 0; first < count; first += chunk) {
    stop_if_cancelled();
    const std::uint64_t n = std::min(chunk, count - first);
    records.resize(n * stride);
    if (bytes != 0) {
      rows.carried->read(first, records);
      files.write_results(context.cloud, first, records);
    } else if (files.are_tiles()) {
      files.write_tiled_inputs(n);
    } else {
      inputs.read(first, records);
      files.write_piece(first, records);
    }
    context.progress("writing", first + n);
  }
}

/// Writes the records of the stream in their order: records of the output after passes, records of the input in a sort.
void write_ordered(const Context& context, const WorkPlan& work, const Stream& stream, OutputFiles& files) {
  const std::size_t bytes = work.layout ? work.layout->schema().stride : context.cloud.schema().stride;
  std::uint64_t first = 0;
  const auto write = [&](std::span<const std::byte> records) {
    with_rows_of_output([&] { work.layout ? files.write_records(records) : files.write_inputs(first, records); });
    first += records.size() / bytes;
  };
  write_in_order(stream, bytes, write, context.progress_of("writing"));
  context.statistics().bytes_spilled += stream.spilled_bytes();
  context.statistics().bytes_spilled_ordering += stream.spilled_bytes();
}

}  // namespace

void write_output(const Context& context, const WorkPlan& work, std::size_t p, const Rows& rows, const Ordered* ordered,
                  RowStore* results, OutputFiles& files) {
  const auto start = std::chrono::steady_clock::now();
  if (files.are_tiles() && context.places.checkpoints() != nullptr) context.places.checkpoints()->writing_tiles();
  if (ordered != nullptr)
    write_ordered(context, work, ordered->stream, files);
  else if (context.is_empty() || p == context.plan.passes.size())
    write_rows(context, rows, files);
  else if (context.makes_output(p))
    write_whole(context, *results, work.layout->schema().stride, files);
  else
    write_made(context, p, rows, results, files);
  if (results != nullptr) context.statistics().bytes_spilled += results->spilled_bytes();
  context.statistics().write_seconds += seconds_since(start);
}

}  // namespace pointsweep
