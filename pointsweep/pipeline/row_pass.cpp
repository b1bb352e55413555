// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/row_pass.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "pointsweep/sweep/file_column.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::size_t kRowBatch = 1024;
constexpr std::size_t kRowChunkBytes = 1 << 20;

}  // namespace

RowPass::RowPass(const PlannedPass& pass) : pass_(pass), position_(position_fields(pass.input, "the input")) {}

void RowPass::run(const PointSource& source,
                  const std::function<void(std::uint64_t, std::size_t, const std::byte*)>& use) {
  const std::size_t stride = source.schema.stride, bytes = pass_.plan.result_bytes;
  const std::size_t chunk = std::max<std::size_t>(1, kRowChunkBytes / stride);
  std::vector<std::byte> records, results;
  std::vector<StageTally> tallies(thread_count());
  for (std::uint64_t row = 0; row < source.count;) {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(chunk, source.count - row));
    records.resize(n * stride);
    read_fully(source, row, records);
    results.resize(n * bytes);
    parallel_for((n + kRowBatch - 1) / kRowBatch, [&](std::size_t batch, unsigned worker) {
      const std::size_t first = batch * kRowBatch;
      run_batch(records.data() + first * stride, row + first, std::min(kRowBatch, n - first), tallies[worker],
                results.data() + first * bytes);
    });
    use(row, n, results.data());
    row += n;
  }
  tally_.seconds.assign(pass_.plan.stages.size(), 0);
  tally_.degenerate.resize(pass_.plan.stages.size());
  for (const StageTally& t : tallies) {
    for (std::size_t s = 0; s < t.seconds.size(); ++s) tally_.seconds[s] += t.seconds[s];
    add_rows(tally_.degenerate, t.degenerate);
  }
}

void RowPass::run_batch(const std::byte* records, std::uint64_t first_row, std::size_t size, StageTally& tally,
                        std::byte* results) const {
  const SweepPlan& plan = pass_.plan;
  std::vector<double> xyz(3 * size);
  double *x = xyz.data(), *y = x + size, *z = y + size;
  decode_positions(position_, records, pass_.input.stride, size, x, y, z);
  std::vector<std::uint64_t> rows(size);
  for (std::size_t i = 0; i < size; ++i) rows[i] = first_row + i;
  std::vector<std::vector<std::byte>> columns;
  std::vector<std::byte*> made;
  for (const std::uint32_t bytes : plan.column_bytes) columns.emplace_back(size * bytes);
  for (auto& column : columns) made.push_back(column.data());
  for (const FileColumn& file : plan.file_columns)
    fill_file_column(file, pass_.input, records, size, made[file.column]);
  const std::vector<const std::byte*> own(made.begin(), made.end());
  const std::vector<std::uint32_t> no_lists(size + 1, 0);
  const PointColumns points{x, y, z, rows.data(), own.data()};
  const Batch batch{points, size, nullptr, no_lists.data(), nullptr, made.data()};
  tally.degenerate.resize(plan.stages.size());
  for (std::size_t step = 0; step < plan.step_count(); ++step) {
    run_step(plan, step, batch, tally);
    for_each_marked(plan, step, tally, [&](std::size_t s, std::size_t i) { tally.degenerate[s].add(rows[i]); });
  }
  std::vector<std::byte> collected;
  collect_results(plan, own.data(), size, collected);
  for (std::size_t i = 0; i < size; ++i)
    if (!is_finite(Vec3{x[i], y[i], z[i]}))
      give_none(position_, records + i * pass_.input.stride, collected.data() + i * plan.result_bytes);
  std::ranges::copy(collected, results);
}

/// What is made of a point without a finite place: values of none, and the position it has; a select has decided.
void RowPass::give_none(const PositionFields& position, const std::byte* record, std::byte* result) const {
  for (const Attribute& a : pass_.made) {
    if (a.name == position_attribute().name || a.name == stream_position_attribute().name) {
      const double place[3] = {value_of(position.x, record), value_of(position.y, record),
                               value_of(position.z, record)};
      std::memcpy(result, place, sizeof place);
    } else if (a.name != selection_attribute().name) {
      std::fill_n(result, a.bytes(), a.fill);
    }
    result += a.bytes();
  }
}

}  // namespace pointsweep
