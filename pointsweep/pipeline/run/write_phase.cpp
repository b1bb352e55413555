// SPDX-License-Identifier: MIT
/// Writes the output: what the last pass makes, the rows that it has left, or the records that were put in order.
#include <algorithm>

#include "pointsweep/cancellation.h"
#include "pointsweep/order/parallel_rows.h"
#include "pointsweep/pipeline/run/made_rows.h"
#include "pointsweep/pipeline/run/output_files.h"
#include "pointsweep/pipeline/run/phases.h"

namespace pointsweep {
namespace {

/// Whole output records, in the order of the stream of the last pass.
void write_whole(RunState& run) {
  const std::size_t stride = run.files->layout().schema().stride;
  run.results->drain([&](std::uint64_t first, std::span<const std::byte> records) {
    run.files->write_records(records);
    run.report("writing", first + records.size() / stride, 0);
  });
}

void write_results(RunState& run, std::uint64_t first, std::span<const std::byte> results) {
  run.tiles ? run.tiles->write_results(first, results) : run.files->write_results(run.cloud, first, results);
}

/// Writes the results of the last pass by row, while they are made or afterwards.
void write_made(RunState& run, std::size_t p) {
  const auto use = [&run](std::uint64_t first, std::size_t n, const std::byte* records, std::size_t bytes) {
    write_results(run, first, {records, n * bytes});
    run.report("writing", first + n, 0);
  };
  const std::size_t bytes = run.plan.passes[p].plan.result_bytes;
  const MadeRows made = made_by_pass(run, p);
  if (p == 0)
    return made([&](std::uint64_t first, std::size_t n, const std::byte* records) { use(first, n, records, bytes); });
  const RowUpdate after = update_after(run.plan, p);
  update_rows(made, run.rows.get(), after, bytes,
              [&](const UpdatedRows& rows) { use(rows.first, rows.count, rows.after, after.record_bytes()); });
}

/// The rows that the last pass has left.
void write_rows(RunState& run) {
  std::size_t bytes = 0;
  for (const Attribute& a : run.plan.made) bytes += a.bytes();
  const std::size_t stride = bytes != 0 ? bytes : run.cloud.schema().stride;
  const std::uint64_t chunk = std::max<std::size_t>(1, (std::size_t{4} << 20) / stride);
  ParallelRows inputs(run.cloud_source());
  std::vector<std::byte> records;
  for (std::uint64_t first = 0; first < run.cloud.count(); first += chunk) {
    stop_if_cancelled();
    records.resize(std::min(chunk, run.cloud.count() - first) * stride);
    if (bytes != 0) {
      run.rows->read(first, records);
      write_results(run, first, records);
    } else if (run.tiles) {
      run.tiles->write_inputs(first, records.size() / stride);
    } else {
      inputs.read(first, records);
      run.files->write_inputs(first, records);
    }
    run.report("writing", first + records.size() / stride, 0);
  }
}

/// Writes the records of the stream: records of the output after passes, records of the input in a sort.
void write_ordered(RunState& run) {
  const std::size_t bytes = run.layout ? run.layout->schema().stride : run.cloud.schema().stride;
  std::uint64_t first = 0;
  const auto write = [&](std::span<const std::byte> records) {
    run.layout ? run.files->write_records(records) : run.files->write_inputs(first, records);
    first += records.size() / bytes;
  };
  write_in_order(*run.stream, bytes, write, [&run](std::uint64_t done) { run.report("writing", done, 0); });
  run.statistics.bytes_spilled += run.stream->spilled_bytes();
  run.statistics.bytes_spilled_ordering += run.stream->spilled_bytes();
}

void write_output(RunState& run, std::size_t p) {
  if (run.stream) return write_ordered(run);
  if (run.is_empty() || p == run.plan.passes.size()) return write_rows(run);
  run.makes_output(p) ? write_whole(run) : write_made(run, p);
}

}  // namespace

void write_phase(RunState& run, std::size_t p) {
  const auto start = std::chrono::steady_clock::now();
  if (!run.files && !run.tiles) open_late(run);
  if (run.tiles && run.checkpoints) run.checkpoints->writing_tiles();
  write_output(run, p);
  if (run.results) run.statistics.bytes_spilled += run.results->spilled_bytes();
  run.statistics.write_seconds += seconds_since(start);
}

}  // namespace pointsweep
