// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/recall.h"

#include <algorithm>

#include "pointsweep/free_memory.h"
#include "pointsweep/sweep/recalled_points.h"

namespace pointsweep {
namespace {

/// The share of the memory that a group of points is planned to take. The memory that the group really takes is known
/// only afterwards.
constexpr double kPlannedShare = 0.7;
/// The largest factor by which the size of a group grows from one group to the next.
constexpr std::size_t kMostGrowth = 4;

}  // namespace

/// Returns the number of points of the first group. On a surface, the values of a deferred point depend on about
/// k (steps + 1)² points.
std::size_t Recall::first_guess() const {
  const double k = static_cast<double>(std::min<std::size_t>(plan_.neighborhood.k, 100'000));
  const double width = static_cast<double>(plan_.step_count()) + 1;
  const double point = static_cast<double>(window_point_bytes(plan_)) + sizeof(NeighborRef) * k;
  return std::max<std::size_t>(
      1, static_cast<std::size_t>(static_cast<double>(memory_.bytes) / (k * width * width * point)));
}

void Recall::run(Sink& sink, const std::function<void(std::size_t points, std::size_t left)>& done) {
  Worker& worker = workers_.front();
  worker.deferred = take_deferred();
  group_ = first_guess();
  while (!worker.deferred.empty()) {
    return_free_memory_above(memory_.spare_bytes);  // the sweep or the previous group has freed memory
    const std::size_t points = run_group(worker.deferred, sink);
    worker.certified += points;
    done(points, worker.deferred.size());
  }
}

/// Returns the deferred points of all workers by descending slab, within a slab by descending row, since groups are
/// taken from the end.
std::vector<DeferredPoint> Recall::take_deferred() {
  std::size_t count = 0;
  for (const Worker& worker : workers_) count += worker.deferred.size();
  std::vector<DeferredPoint> deferred;
  deferred.reserve(count);
  for (Worker& worker : workers_) {
    deferred.insert(deferred.end(), worker.deferred.begin(), worker.deferred.end());
    free_memory_of(worker.deferred);
  }
  std::ranges::sort(deferred, [](const DeferredPoint& a, const DeferredPoint& b) {
    return a.slab != b.slab ? a.slab > b.slab : a.row > b.row;
  });
  return deferred;
}

/// Finishes points from the end of `points`, as many as fit in memory, at least one. Removes them from `points` and
/// returns their number.
std::size_t Recall::run_group(std::vector<DeferredPoint>& points, Sink& sink) {
  for (;;) {
    const std::size_t size = std::min(group_, points.size());
    RecalledPoints recalled(stream_, plan_, loader_, frontier_, memory_, workers_);
    const bool fits = recalled.gather(std::span(points).last(size));
    slabs_read_.add(recalled.slabs_read());
    if (!fits) {
      group_ = std::max<std::size_t>(1, size / 2);
      continue;
    }
    const std::size_t finished = recalled.finish(sink);
    const double each = static_cast<double>(recalled.bytes()) / static_cast<double>(size);
    const double planned = kPlannedShare * static_cast<double>(memory_.bytes) / each;
    group_ = static_cast<std::size_t>(std::clamp(planned, 1.0, static_cast<double>(kMostGrowth * size)));
    points.erase(points.end() - static_cast<std::ptrdiff_t>(size), points.end());
    return finished;
  }
}

}  // namespace pointsweep
