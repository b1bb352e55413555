// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/cell_runner.h"

#include "pointsweep/sweep/apply_step.h"
#include "pointsweep/sweep/certify.h"

namespace pointsweep {

CellRunner::CellRunner(const SweepPlan& plan, Window& window, const Frontier& frontier, Sink& sink,
                       const ListMemory& memory)
    : plan_(plan),
      window_(window),
      frontier_(frontier),
      sink_(sink),
      read_of_neighbors_(plan.column_bytes.size()),
      lists_(plan, window, memory) {
  for (const Stage& stage : plan.stages)
    for (const std::uint16_t column : stage.reads_neighbors) read_of_neighbors_[column] = true;
}

void CellRunner::run(std::uint32_t slot, std::uint32_t step, Worker& worker) const {
  WindowCell& cell = window_.at(slot);
  bool all_found = false;
  if (step == 0) {
    all_found = lists_.find_reaches(slot, worker);
    if (!certify(cell, frontier_, worker)) return;
  }
  place_columns(plan_, step, cell, worker);
  step == 0 ? run_first_step(slot, all_found, worker) : run_later_step(slot, step, worker);
  cell.steps_done = step + 1;
  if (cell.steps_done == plan_.step_count()) finish(cell, worker);
}

/// The lists of a cell are found run by run. Each run is used at once; later steps keep what fits.
void CellRunner::run_first_step(std::uint32_t slot, bool all_found, Worker& worker) const {
  WindowCell& cell = window_.at(slot);
  const bool later = plan_.step_count() > 1;
  bool kept = later;
  for (std::uint32_t first = 0, size = cell.cell.size(); first < size;) {
    const CellSubset rest(first, size);
    const CellSubset run = rest.part(0, all_found ? size : lists_.find(slot, rest, worker));
    if (later) CellLists::note_references(cell, first, worker.neighbors, worker);
    lists_.truncate(cell, run, worker);
    kept = kept && lists_.keep(cell, worker.neighbors);
    apply(0, cell, run, worker.neighbors, worker);
    first += run.size();
  }
  if (!later) return;
  CellLists::hold_references(cell, worker);
  if (!kept) return lists_.release(cell);
  if (!plan_.neighborhood.rule) return;
  std::uint32_t first = 0;
  for (const CellNeighbors& lists : cell.lists) {
    CellLists::note_references(cell, first, lists, worker);
    first += lists.size();
  }
  CellLists::hold_references(cell, worker);
}

/// Takes a later step with the lists that were kept, or finds equal lists again: no point has come into their certified
/// balls, and the cells that they name are still in the window.
void CellRunner::run_later_step(std::uint32_t slot, std::uint32_t step, Worker& worker) const {
  WindowCell& cell = window_.at(slot);
  const std::uint32_t size = cell.cell.size();
  std::uint32_t first = 0;
  const auto use = [&](const CellNeighbors& lists) {
    defer_dependents(plan_.neighborhood, cell, first, lists, window_);
    apply(step, cell, {first, first + lists.size()}, lists, worker);
    first += lists.size();
  };
  for (const CellNeighbors& lists : cell.lists) use(lists);
  while (first < size) {
    const CellSubset rest(first, size);
    lists_.truncate(cell, rest.part(0, lists_.find(slot, rest, worker)), worker);
    use(worker.neighbors);
  }
}

/// Applies the step to the points of the run that are not deferred, and marks degenerate points in the cell.
void CellRunner::apply(std::uint32_t step, WindowCell& cell, const CellSubset& run, const CellNeighbors& lists,
                       Worker& worker) const {
  const auto mark = [&](const CellSubset& part) {
    for_each_marked(plan_, step, worker.tally, [&](std::size_t stage, std::size_t n) {
      if (cell.degenerate.empty()) cell.degenerate.resize(plan_.stages.size());
      cell.degenerate[stage].mark(part[static_cast<std::uint32_t>(n)]);
    });
  };
  if (cell.deferred.empty())
    return apply_step(plan_, step, cell.cell, run, lists, window_.slots(), worker, worker.tally, mark);
  std::vector<std::uint32_t> chosen, numbers;
  for (std::uint32_t n = 0; n < run.size(); ++n) {
    if (cell.is_deferred(run[n])) continue;
    chosen.push_back(run[n]);
    numbers.push_back(n);
  }
  worker.chosen_lists = lists;
  keep_lists_of(numbers, worker.chosen_lists);
  apply_step(plan_, step, cell.cell, chosen, worker.chosen_lists, window_.slots(), worker, worker.tally, mark);
}

void CellRunner::finish(WindowCell& cell, Worker& worker) const {
  if (!cell.was_finished) hand_over(cell, worker);
  cell.left_to_recall = {}, cell.unresolved = {};
  lists_.release(cell);
  cell.refers_to = {};
  if (plan_.step_count() == 1) drop_columns(cell);
}

void CellRunner::hand_over(const WindowCell& cell, Worker& worker) const {
  worker.certified += cell.certified;
  worker.tally.degenerate.resize(plan_.stages.size());
  for (std::size_t s = 0; s < cell.degenerate.size(); ++s)
    cell.degenerate[s].for_each([&](std::size_t i) { worker.tally.degenerate[s].add(cell.cell.row[i]); });
  worker.deferred.insert(worker.deferred.end(), cell.left_to_recall.begin(), cell.left_to_recall.end());
  worker.unresolved.insert(worker.unresolved.end(), cell.unresolved.begin(), cell.unresolved.end());
  for (std::uint32_t i = 0; i < cell.deferred.size(); ++i)
    if (cell.is_deferred(i)) sink_.deferred(cell.slab, cell.index_in_slab[i]);
  collect_results(plan_, worker.columns.data(), cell.cell.size(), worker.results);
  // The runs between deferred and unresolved points. The recall finishes the deferred ones.
  for (std::uint32_t i = 0; i < cell.cell.size();) {
    std::uint32_t end = i;
    while (end < cell.cell.size() && !cell.is_deferred(end)) ++end;
    if (end > i) {
      worker.unwritten.note_from([&] {
        sink_.finished({cell.slab, cell.index_in_slab.data() + i, cell.cell.row + i,
                        worker.results.data() + std::size_t{i} * plan_.result_bytes, end - i});
      });
    }
    i = end + 1;
  }
}

/// After the only step others may still read some of what the file gave.
void CellRunner::drop_columns(WindowCell& cell) const {
  for (std::size_t c = 0; c < cell.columns.size(); ++c) {
    if (read_of_neighbors_[c]) continue;
    cell.columns[c] = {};
    cell.column_pointers[c] = nullptr;
  }
}

}  // namespace pointsweep
