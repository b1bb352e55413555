// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/sweep_restart.h"

#include <algorithm>
#include <functional>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

constexpr Encoding kProgressEncoding{"sweep progress", 1};

/// The reciprocal of the largest share of unfinished points that may lie before the slabs to be read again. These
/// points are sparse and have waited for long.
constexpr std::uint64_t kLeftBehind = 64;

}  // namespace

SweepProgress progress_of(const Stream& stream, const SweepPlan& plan, const Frontier& frontier, const Window& window,
                          const std::vector<Worker>& workers, const SweepStatistics& statistics) {
  SweepProgress p;
  p.slabs_read = static_cast<std::uint32_t>(frontier.slabs_read());
  for (const Worker& worker : workers) {
    p.deferred.insert(p.deferred.end(), worker.deferred.begin(), worker.deferred.end());
    p.certified += worker.certified;
    add_rows(p.degenerate, worker.tally.degenerate);
  }
  p.recalled = statistics.recalled;
  p.recalled_slabs = statistics.recalled_slabs;
  p.peak_points = statistics.peak_points;
  for (std::uint32_t slab = 0; slab < p.slabs_read; ++slab)
    for (const DroppedCell& cell : frontier.dropped_of(slab)) p.dropped.push_back({slab, cell});
  frontier.for_each_saturated_location([&](Vec3 place, std::uint64_t row) {
    p.saturated_locations.push_back({place, row});
  });
  if (p.slabs_read == stream.slabs().size()) return p;  // the recall, which follows, does not use the window
  for (const std::uint32_t slot : window.occupied()) {
    const WindowCell& cell = window.at(slot);
    const bool finished = cell.is_only_looked_at || cell.steps_done == plan.step_count();
    p.window.push_back({cell.slab, cell.number, cell.cell.size(), finished, cell.reach});
  }
  return p;
}

SweepRestart::SweepRestart(const SweepProgress& from, const Stream& stream, const SweepPlan& plan)
    : from_(from), stream_(stream), plan_(plan), first_slab_(slab_to_begin_with()) {
  for (const WindowedCell& cell : from.window) window_[{cell.slab, cell.number}] = cell;
  for (const DeferredPoint& point : from.deferred) deferred_[point.slab].push_back(point.index_in_slab);
}

/// Returns the slab to read first. In a plan with a single step, a point needs only file columns of its neighbours, and
/// these neighbours are in the window. Otherwise a value of step s depends on values of step s-1 of the neighbours, and
/// so on; reading one slab further back for each step usually suffices.
std::uint32_t SweepRestart::slab_to_begin_with() const {
  std::uint32_t slab = from_.slabs_read;
  if (plan_.step_count() == 1 || slab == stream_.slabs().size()) return slab;
  std::vector<std::pair<std::uint32_t, std::uint64_t>> unfinished;  // slab and number of points of each unfinished cell
  std::uint64_t left = 0;
  for (const WindowedCell& cell : from_.window) {
    if (cell.finished != 0) continue;
    unfinished.emplace_back(cell.slab, cell.points);
    left += cell.points;
  }
  std::ranges::sort(unfinished, std::greater());
  const std::uint64_t left_behind = left / kLeftBehind;
  for (const auto& [at, points] : unfinished) {
    if (left <= left_behind) break;
    slab = std::min(slab, at);
    left -= points;
  }
  return slab - std::min(slab, static_cast<std::uint32_t>(plan_.step_count()));
}

void SweepRestart::restore(const SlabLoader& loader, Window& window, Frontier& frontier, Sink& sink,
                           Worker& worker) const {
  worker.deferred = from_.deferred;
  worker.certified = from_.certified;
  worker.tally.degenerate = from_.degenerate;
  frontier.slabs_were_read(first_slab_);
  for (const auto& [slab, cell] : from_.dropped)
    if (slab < first_slab_) frontier.cell_was_dropped(static_cast<std::uint32_t>(slab), cell);
  for (const SaturatedLocation& full : from_.saturated_locations) frontier.location_is_saturated(full.place, full.row);
  for (std::uint32_t slab = 0; slab < first_slab_; ++slab) {
    if (!was_in_window(slab) && !(sink.wants_records() && deferred_.contains(slab))) continue;
    LoadedSlab loaded = loader.load(slab, sink.wants_records());
    prepare(slab, loaded, sink);
    for (auto& cell : loaded.cells)
      if (window_.contains({slab, cell->number})) window.admit(std::move(cell));
  }
}

bool SweepRestart::was_in_window(std::uint32_t slab) const {
  const auto at = window_.lower_bound({slab, 0});
  return at != window_.end() && at->first.first == slab;
}

void SweepRestart::prepare(std::uint32_t slab, LoadedSlab& loaded, Sink& sink) const {
  if (!was_read(slab)) return;
  std::uint64_t unfinished = 0;
  for (const auto& cell : loaded.cells) {
    mark(*cell);
    if (!cell->is_only_looked_at) unfinished += cell->cell.size();
  }
  if (sink.wants_records()) tell(slab, std::move(loaded.records), unfinished, sink);
}

void SweepRestart::mark(WindowCell& cell) const {
  const auto at = window_.find({cell.slab, cell.number});
  cell.is_only_looked_at = at == window_.end() || at->second.finished != 0;
  if (at == window_.end()) return;
  if (at->second.points != cell.cell.size())
    fail("a checkpoint is of a build that cuts its points otherwise: remove its folder and start again.");
  if (!cell.is_only_looked_at || plan_.step_count() > 1) return;
  cell.steps_done = 1;
  cell.reach = at->second.reach;
}

void SweepRestart::tell(std::uint32_t slab, std::vector<std::byte> records, std::uint64_t unfinished,
                        Sink& sink) const {
  sink.slab_read(slab, std::move(records));
  std::uint64_t left = unfinished;
  if (const auto deferred = deferred_.find(slab); deferred != deferred_.end()) {
    for (const std::uint32_t index : deferred->second) sink.deferred(slab, index);
    left += deferred->second.size();
  }
  if (const std::uint64_t finished = stream_.slabs()[slab].count - left; finished > 0)
    sink.were_finished(slab, finished);
}

void SweepProgress::encode(Encoder& out) const {
  out.begin(kProgressEncoding);
  out.put<std::uint32_t>(slabs_read);
  out.put_list(window, [&](const WindowedCell& cell) {
    for (const std::uint32_t number : {cell.slab, cell.number, cell.points, cell.finished})
      out.put<std::uint32_t>(number);
    out.put<double>(cell.reach);
  });
  out.put_list(dropped, [&](const DroppedCellOfSlab& dropped_cell) {
    out.put<std::uint64_t>(dropped_cell.slab);
    out.put_box(dropped_cell.cell.box);
    out.put<std::uint32_t>(dropped_cell.cell.number);
    out.put<std::uint32_t>(dropped_cell.cell.points);
  });
  out.put_list(saturated_locations, [&](const SaturatedLocation& location) {
    out.put_point(location.place);
    out.put<std::uint64_t>(location.row);
  });
  out.put_list(deferred, [&](const DeferredPoint& point) {
    out.put_point(point.position);
    out.put<std::uint64_t>(point.row);
    out.put<std::uint32_t>(point.slab);
    out.put<std::uint32_t>(point.index_in_slab);
    out.put<double>(point.reach2);
    out.put<std::uint32_t>(point.step);
  });
  for (const std::uint64_t count : {certified, recalled, recalled_slabs, peak_points}) out.put<std::uint64_t>(count);
  out.put_list(degenerate, [&](const DegenerateRows& rows) {
    out.put<std::uint64_t>(rows.count());
    out.put_numbers<std::uint64_t>(rows.lowest());
  });
}

SweepProgress SweepProgress::decode(Decoder& in) {
  const auto u32 = [&in] { return in.get<std::uint32_t>(); };
  const auto u64 = [&in] { return in.get<std::uint64_t>(); };
  const auto f64 = [&in] { return in.get<double>(); };
  in.begin(kProgressEncoding);
  SweepProgress p;
  p.slabs_read = u32();
  p.window = in.get_list<WindowedCell>([&] { return WindowedCell{u32(), u32(), u32(), u32(), f64()}; });
  p.dropped = in.get_list<DroppedCellOfSlab>([&] { return DroppedCellOfSlab{u64(), {in.get_box(), u32(), u32()}}; });
  p.saturated_locations = in.get_list<SaturatedLocation>([&] { return SaturatedLocation{in.get_point(), u64()}; });
  p.deferred =
      in.get_list<DeferredPoint>([&] { return DeferredPoint{in.get_point(), u64(), u32(), u32(), f64(), u32()}; });
  for (std::uint64_t* count : {&p.certified, &p.recalled, &p.recalled_slabs, &p.peak_points}) *count = u64();
  p.degenerate = in.get_list<DegenerateRows>([&] {
    const std::uint64_t count = u64();
    std::vector<std::uint64_t> lowest = in.get_numbers<std::uint64_t>();
    if (lowest.size() > std::min<std::uint64_t>(count, DegenerateRows::kMostListed))
      fail("A stored list of degenerate rows is damaged.");
    return DegenerateRows(count, std::move(lowest));
  });
  return p;
}

}  // namespace pointsweep
