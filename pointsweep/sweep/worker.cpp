// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/worker.h"

#include <algorithm>

#include "pointsweep/cancellation.h"
#include "pointsweep/points/record_map.h"

namespace pointsweep {
namespace {

/// The most neighbours that an operator gets at once, unless a single point has more.
constexpr std::uint32_t kMostAtOnce = 1u << 18;

/// Applies the step to successive points of the cell, whose columns it reads and fills in place.
void apply_to_run(const SweepPlan& plan, std::uint32_t step, const Cell& cell, const CellSubset& points, Batch batch,
                  Worker& worker, StageTally& tally) {
  const std::uint32_t first = points[0];
  std::vector<std::byte*>& columns = worker.run_columns;
  columns.clear();
  for (std::size_t c = 0; c < worker.columns.size(); ++c) {
    std::byte* const column = worker.columns[c];
    columns.push_back(column == nullptr ? nullptr : column + std::size_t{first} * plan.column_bytes[c]);
  }
  batch.own = {cell.x + first, cell.y + first, cell.z + first, cell.row + first, columns.data()};
  batch.made = columns.data();
  run_step(plan, step, batch, tally);
}

void apply_to_chosen(const SweepPlan& plan, std::uint32_t step, const Cell& cell, const CellSubset& points, Batch batch,
                     Worker& worker, StageTally& tally) {
  ChosenPoints& chosen = worker.chosen;
  chosen.take(plan, cell, points, worker.columns.data());
  chosen.make_columns(plan, step);
  batch.own = chosen.view();
  batch.made = chosen.columns();
  run_step(plan, step, batch, tally);
  chosen.give_back(plan, step, worker.columns.data());
}

/// Calls use(column) for each column that the stages of a step make.
template <class Use>
void for_each_made(const SweepPlan& plan, std::uint32_t step, Use use) {
  for (std::size_t s = plan.steps[step]; s < plan.steps[step + 1]; ++s)
    for (const std::uint16_t column : plan.stages[s].makes) use(column);
}

}  // namespace

void ChosenPoints::take(const SweepPlan& plan, const Cell& cell, const CellSubset& points,
                        const std::byte* const* columns) {
  chosen_.clear();
  for (std::uint32_t n = 0; n < points.size(); ++n) chosen_.push_back(points[n]);
  x_.clear(), y_.clear(), z_.clear(), row_.clear();
  for (const std::uint32_t i : chosen_) {
    x_.push_back(cell.x[i]), y_.push_back(cell.y[i]), z_.push_back(cell.z[i]), row_.push_back(cell.row[i]);
  }
  columns_.resize(plan.column_bytes.size());
  pointers_.assign(plan.column_bytes.size(), nullptr);
  for (std::size_t c = 0; c < plan.column_bytes.size(); ++c) {
    if (columns[c] == nullptr) continue;
    const std::uint32_t bytes = plan.column_bytes[c];
    columns_[c].resize(chosen_.size() * bytes);
    pointers_[c] = columns_[c].data();
    with_fixed_size(bytes, [&](auto size) {
      for (std::size_t n = 0; n < chosen_.size(); ++n)
        copy_bytes<size()>(pointers_[c] + n * bytes, columns[c] + std::size_t{chosen_[n]} * bytes, bytes);
    });
  }
}

void ChosenPoints::make_columns(const SweepPlan& plan, std::size_t step) {
  for (std::size_t s = plan.steps[step]; s < plan.steps[step + 1]; ++s) {
    for (const std::uint16_t c : plan.stages[s].makes) {
      if (pointers_[c] != nullptr) continue;
      columns_[c].assign(chosen_.size() * plan.column_bytes[c], std::byte{0});
      pointers_[c] = columns_[c].data();
    }
  }
}

void ChosenPoints::give_back(const SweepPlan& plan, std::size_t step, std::byte* const* columns) const {
  for (std::size_t s = plan.steps[step]; s < plan.steps[step + 1]; ++s) {
    for (const std::uint16_t c : plan.stages[s].makes) {
      if (columns[c] == nullptr) continue;
      const std::uint32_t bytes = plan.column_bytes[c];
      with_fixed_size(bytes, [&](auto size) {
        for (std::size_t n = 0; n < chosen_.size(); ++n)
          copy_bytes<size()>(columns[c] + std::size_t{chosen_[n]} * bytes, pointers_[c] + n * bytes, bytes);
      });
    }
  }
}

void place_cell_columns(const SweepPlan& plan, std::uint32_t step, WindowCell& cell, Worker& worker) {
  for_each_made(plan, step, [&](std::uint16_t c) {
    if (plan.lifetimes[c] == Lifetime::cell) cell.make_column(c, plan.column_bytes[c]);
  });
  worker.columns.clear();
  for (auto& column : cell.columns) worker.columns.push_back(column.empty() ? nullptr : column.data());
}

void place_columns(const SweepPlan& plan, std::uint32_t step, WindowCell& cell, Worker& worker) {
  place_cell_columns(plan, step, cell, worker);
  constexpr std::size_t kLine = 64;
  const auto for_each_passing = [&](auto use) {
    for_each_made(plan, step, [&](std::uint16_t c) {
      const std::size_t bytes = std::size_t{plan.column_bytes[c]} * cell.cell.size();
      if (plan.lifetimes[c] != Lifetime::cell) use(c, (bytes + kLine - 1) / kLine * kLine);
    });
  };
  std::size_t passing = 0;
  for_each_passing([&](std::uint16_t, std::size_t bytes) { passing += bytes; });
  worker.passing.assign(passing, std::byte{0});
  std::byte* at = worker.passing.data();
  for_each_passing([&](std::uint16_t c, std::size_t bytes) { worker.columns[c] = at, at += bytes; });
}

void keep_lists_of(std::span<const std::uint32_t> kept, CellNeighbors& lists) {
  std::uint32_t end = 0;
  for (std::uint32_t n = 0; n < kept.size(); ++n) {
    const std::uint32_t begin = lists.begin[kept[n]], behind = lists.begin[kept[n] + 1];
    std::copy(lists.refs.begin() + begin, lists.refs.begin() + behind, lists.refs.begin() + end);
    lists.begin[n] = end;
    end += behind - begin;
  }
  lists.begin[kept.size()] = end;
  lists.begin.resize(kept.size() + 1);
  lists.refs.resize(end);
}

void apply_step(const SweepPlan& plan, std::uint32_t step, const Cell& cell, const CellSubset& points,
                const CellNeighbors& lists, const PointColumns* slots, Worker& worker, StageTally& tally,
                const std::function<void(const CellSubset& part)>& done) {
  for (std::uint32_t n = 0, end = 0; n < points.size(); n = end) {
    stop_if_cancelled();
    for (end = n + 1; end < points.size() && lists.begin[end + 1] - lists.begin[n] <= kMostAtOnce;) ++end;
    const CellSubset part = points.part(n, end - n);
    Batch batch;
    batch.size = part.size();
    batch.slots = slots;
    batch.begin = lists.begin.data() + n;
    batch.refs = lists.refs.data();
    part.is_run() ? apply_to_run(plan, step, cell, part, batch, worker, tally)
                  : apply_to_chosen(plan, step, cell, part, batch, worker, tally);
    done(part);
  }
}

}  // namespace pointsweep
