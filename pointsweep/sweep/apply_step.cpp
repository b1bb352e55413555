// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/apply_step.h"

#include <algorithm>

#include "pointsweep/cancellation.h"

namespace pointsweep {
namespace {

/// Neighbours that an operator gets at once, unless one point has more.
constexpr std::uint32_t kMostAtOnce = 1u << 18;

/// Some of the lists at hand: that of point n is refs[begin[n] .. begin[n + 1]).
struct ListedPart {
  std::uint32_t first, size;
  const std::uint32_t* begin;
  const NeighborRef* refs;
};

template <class Use>
void for_each_part(const CellNeighbors& lists, Use use) {
  for (std::uint32_t i = 0, end = 0; i < lists.size(); i = end) {
    stop_if_cancelled();
    for (end = i + 1; end < lists.size() && lists.begin[end + 1] - lists.begin[i] <= kMostAtOnce;) ++end;
    use(ListedPart{i, end - i, lists.begin.data() + i, lists.refs.data()});
  }
}

void mark_degenerate(const SweepPlan& plan, WindowCell& cell, std::size_t stage, std::size_t i) {
  if (cell.degenerate.empty()) cell.degenerate.resize(plan.stages.size());
  cell.degenerate[stage].mark(i);
}

void apply_to_all(const SweepPlan& plan, std::uint32_t step, WindowCell& cell, std::uint32_t first,
                  const ListedPart& part, const PointColumns* slots, Worker& worker) {
  std::vector<std::byte*>& columns = worker.run_columns;
  columns.clear();
  for (std::size_t c = 0; c < worker.columns.size(); ++c) {
    std::byte* const column = worker.columns[c];
    columns.push_back(column == nullptr ? nullptr : column + std::size_t{first} * plan.column_bytes[c]);
  }
  const Cell& points = cell.cell;
  const PointColumns own{points.x + first, points.y + first, points.z + first, points.row + first, columns.data()};
  run_step(plan, step, {own, part.size, slots, part.begin, part.refs, columns.data()}, worker.tally);
  for_each_marked(plan, step, worker.tally,
                  [&](std::size_t stage, std::size_t i) { mark_degenerate(plan, cell, stage, first + i); });
}

void apply_to_chosen(const SweepPlan& plan, std::uint32_t step, const Cell& cell, std::span<const std::uint32_t> chosen,
                     const ListedPart& part, const PointColumns* slots, Worker& worker, StageTally& tally) {
  ChosenPoints& points = worker.chosen;
  points.take(plan, cell, chosen, worker.columns);
  points.make_columns(plan, step);
  run_step(plan, step, {points.view(), chosen.size(), slots, part.begin, part.refs, points.columns()}, tally);
  points.give_back(plan, step, worker.columns);
}

/// The points of a part that are not deferred, and their lists.
void apply_to_others(const SweepPlan& plan, std::uint32_t step, WindowCell& cell, std::uint32_t first,
                     const ListedPart& part, const PointColumns* slots, Worker& worker) {
  std::vector<std::uint32_t> chosen;
  CellNeighbors& lists = worker.chosen_lists;
  lists.refs.clear();
  lists.begin.assign(1, 0);
  for (std::uint32_t n = 0; n < part.size; ++n) {
    if (cell.is_deferred(first + n)) continue;
    chosen.push_back(first + n);
    lists.refs.insert(lists.refs.end(), part.refs + part.begin[n], part.refs + part.begin[n + 1]);
    lists.begin.push_back(static_cast<std::uint32_t>(lists.refs.size()));
  }
  const ListedPart others{0, lists.size(), lists.begin.data(), lists.refs.data()};
  apply_to_chosen(plan, step, cell.cell, chosen, others, slots, worker, worker.tally);
  for_each_marked(plan, step, worker.tally,
                  [&](std::size_t stage, std::size_t n) { mark_degenerate(plan, cell, stage, chosen[n]); });
}

/// Calls use(column) for what the stages of a step make.
template <class Use>
void for_each_made(const SweepPlan& plan, std::uint32_t step, Use use) {
  for (std::size_t s = plan.steps[step]; s < plan.steps[step + 1]; ++s)
    for (const std::uint16_t column : plan.stages[s].makes) use(column);
}

}  // namespace

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

void apply_step(const SweepPlan& plan, std::uint32_t step, WindowCell& cell, std::uint32_t first,
                const CellNeighbors& lists, const PointColumns* slots, Worker& worker) {
  for_each_part(lists, [&](const ListedPart& part) {
    cell.deferred.empty() ? apply_to_all(plan, step, cell, first + part.first, part, slots, worker)
                          : apply_to_others(plan, step, cell, first + part.first, part, slots, worker);
  });
}

void apply_step_to(const SweepPlan& plan, std::uint32_t step, const WindowCell& cell,
                   std::span<const std::uint32_t> chosen, const CellNeighbors& lists, const PointColumns* slots,
                   Worker& worker, StageTally& tally, const std::function<void(std::size_t first)>& done) {
  for_each_part(lists, [&](const ListedPart& part) {
    apply_to_chosen(plan, step, cell.cell, chosen.subspan(part.first, part.size), part, slots, worker, tally);
    done(part.first);
  });
}

}  // namespace pointsweep
