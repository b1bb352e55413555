// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/rows/pointwise_stages.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <optional>
#include <utility>

#include "pointsweep/order/source.h"
#include "pointsweep/sweep/slab_loader.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::size_t kBatch = 1024;

/// Returns where a stage reads a field: the number of the attribute and the number of the component; none if the stage
/// does not read it.
std::optional<std::pair<std::size_t, std::size_t>> find_read(const std::string& field,
                                                             const std::vector<Attribute>& reads) {
  for (std::size_t r = 0; r < reads.size(); ++r)
    if (const auto at = std::ranges::find(reads[r].fields, field); at != reads[r].fields.end())
      return std::pair(r, static_cast<std::size_t>(at - reads[r].fields.begin()));
  return std::nullopt;
}

/// Copies component `c` of `size` values of `read`, which begin at `from`, to component `to_c` of as many values of
/// `made` at `to`. Converts numbers if the types differ.
void copy_component(const Attribute& read, std::size_t c, const std::byte* from, const Attribute& made,
                    std::size_t to_c, std::byte* to, std::size_t size) {
  const Field before{.name = "", .type = read.type}, after{.name = "", .type = made.type};
  for (std::size_t i = 0; i < size; ++i, from += read.bytes(), to += made.bytes()) {
    if (read.type == made.type)
      std::memcpy(to + to_c * size_of(made.type), from + c * size_of(read.type), size_of(made.type));
    else
      set_value(after, to, value_of(before, from, static_cast<std::uint32_t>(c)), static_cast<std::uint32_t>(to_c));
  }
}

void copy_positions(const Neighborhoods& in, std::byte* out) {
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Vec3 p = in.position(i);
    std::memcpy(out + i * sizeof p, &p, sizeof p);
  }
}

/// Fills the results of a stage that needs neighbours or the order of all points, for points without a finite place.
/// The position, and attributes of which the stage reads all fields and which it makes again, keep their values; each
/// byte of other made attributes is Attribute::fill.
void leave_unchanged(const Stage& stage, const Batch& batch) {
  const Contract contract = contract_of(stage.op);
  for (std::size_t m = 0; m < stage.makes.size(); ++m) {
    const Attribute& made = contract.makes[m];
    std::byte* const to = batch.made[stage.makes[m]];
    const auto is_read = [&](const std::string& field) { return find_read(field, contract.reads).has_value(); };
    if (made.name == position_attribute().name) {
      copy_positions({batch.own, batch.size, batch.slots, batch.begin, batch.refs, {}, {}, stage.position}, to);
    } else if (!std::ranges::all_of(made.fields, is_read)) {
      std::fill_n(to, batch.size * made.bytes(), made.fill);
    } else {
      for (std::size_t c = 0; c < made.fields.size(); ++c) {
        const auto [read, component] = *find_read(made.fields[c], contract.reads);
        copy_component(contract.reads[read], component, batch.made[stage.reads[read]], made, c, to, batch.size);
      }
    }
  }
}

}  // namespace

PointwiseStages::PointwiseStages(const PlannedPass& pass, const Schema& records)
    : pass_(pass), records_(records), position_(position_fields(records, "the input")), tallies_(thread_count()) {}

void PointwiseStages::run(const std::byte* records, std::span<const std::uint64_t> rows, std::byte* results) {
  parallel_for((rows.size() + kBatch - 1) / kBatch, [&](std::size_t batch, unsigned worker) {
    const std::size_t first = batch * kBatch;
    run_batch(records + first * records_.stride, rows.subspan(first, std::min(kBatch, rows.size() - first)),
              tallies_[worker], results + first * pass_.plan.result_bytes);
  });
  FirstRowError refused;
  for (const StageTally& tally : tallies_) refused.note(tally.refused);
  refused.throw_if_any();
}

void PointwiseStages::run_batch(const std::byte* records, std::span<const std::uint64_t> rows, StageTally& tally,
                                std::byte* results) const {
  const SweepPlan& plan = pass_.plan;
  const std::size_t size = rows.size();
  std::vector<double> xyz(3 * size);
  double *x = xyz.data(), *y = x + size, *z = y + size;
  decode_positions(position_, records, records_.stride, size, x, y, z);
  std::vector<std::vector<std::byte>> columns;
  std::vector<std::byte*> made;
  for (const std::uint32_t bytes : plan.column_bytes) columns.emplace_back(size * bytes);
  for (auto& column : columns) made.push_back(column.data());
  for (const FileColumn& file : plan.file_columns)
    fill_file_column(file, records_, records, rows, made[file.column], tally.refused);
  const std::vector<const std::byte*> own(made.begin(), made.end());
  const std::vector<std::uint32_t> no_lists(size + 1, 0);
  const Batch batch{{x, y, z, rows.data(), own.data()}, size, nullptr, no_lists.data(), nullptr, made.data()};
  for (std::size_t s = 0; s < plan.stages.size(); ++s) {
    if (!is_pointwise(plan.stages[s].op)) {
      leave_unchanged(plan.stages[s], batch);
      continue;
    }
    run_stage(plan, s, batch, tally);
    tally.marked[s].for_each([&](std::size_t i) { tally.degenerate[s].add(rows[i]); });
  }
  std::vector<std::byte> collected;
  collect_results(plan, own.data(), size, collected);
  std::ranges::copy(collected, results);
}

StageTally PointwiseStages::tally() const {
  StageTally all;
  all.seconds.assign(pass_.plan.stages.size(), 0);
  all.degenerate.resize(pass_.plan.stages.size());
  for (const StageTally& t : tallies_) {
    for (std::size_t s = 0; s < t.seconds.size(); ++s) all.seconds[s] += t.seconds[s];
    add_rows(all.degenerate, t.degenerate);
  }
  return all;
}

StageTally run_rows(const PlannedPass& pass, const PointSource& source,
                    const std::function<void(std::uint64_t, std::size_t, const std::byte*)>& use) {
  PointwiseStages stages(pass, pass.input);
  const std::size_t stride = source.schema.stride, most = rows_at_once(stride);
  ParallelRows input(source);
  std::array<std::vector<std::byte>, 2> buffers;  // records in use, and records read ahead
  const auto read = [&](std::size_t turn) {
    const std::uint64_t row = turn * most;
    std::vector<std::byte>& records = buffers[turn % 2];
    records.resize(std::min<std::uint64_t>(most, source.count - row) * stride);
    input.read(row, records);
    return std::span<const std::byte>(records);
  };
  const std::size_t turns = (source.count + most - 1) / most;
  // Reads the records of the next turn in the background; absent if only one thread at a time may read the input.
  std::optional<Prefetch<std::span<const std::byte>>> ahead;
  if (input.is_parallel()) ahead.emplace(read, 0, turns, 1);
  std::vector<std::byte> results;
  std::vector<std::uint64_t> rows;
  for (std::size_t turn = 0; turn < turns; ++turn) {
    const std::span<const std::byte> records = ahead ? ahead->next() : read(turn);
    rows.resize(records.size() / stride);
    std::iota(rows.begin(), rows.end(), turn * most);
    results.resize(rows.size() * pass.plan.result_bytes);
    stages.run(records.data(), rows, results.data());
    use(turn * most, rows.size(), results.data());
  }
  return stages.tally();
}

}  // namespace pointsweep
