// SPDX-License-Identifier: MIT
/// Neighbour lists of the cells of a window or a region: finds and shortens them, stores lists for later steps while
/// memory lasts, and records which cells each list refers to.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

#include "pointsweep/sweep/window.h"
#include "pointsweep/sweep/worker.h"

namespace pointsweep {

/// Adds the seconds of its lifetime to `seconds`.
class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds) {}
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point start_ = Clock::now();
};

struct ListMemory {
  /// Bytes for the cells of the window with their lists. Lists for later steps that do not fit are dropped; a later
  /// step finds equal lists again.
  std::uint64_t cells_bytes;
  /// Bytes for the lists that one thread uses at a time; the list of a single point may take more. A cell with larger
  /// lists is processed in runs of points.
  std::uint64_t lists_bytes;
};

/// Finds, shortens, stores and releases the neighbour lists of cells. Thread-safe for different cells, if each thread
/// has its own worker.
class CellLists {
 public:
  CellLists(const SweepPlan& plan, const CellSet& cells, const ListMemory& memory)
      : plan_(plan), cells_(cells), memory_(memory), point_bytes_(window_point_bytes(plan)) {}

  /// Fills worker.reach2: for each point of the cell, an upper bound of the squared radius of its neighbourhood.
  /// Returns whether worker.neighbors holds the lists of all points of the cell. Without a limit k, the bound is the
  /// squared radius of the plan's neighbourhood, so no search is needed.
  bool find_reaches(std::uint32_t slot, Worker& worker) const;
  /// Finds the lists of the first of `points`: as many lists as fit in ListMemory::lists_bytes, but at least one. The
  /// lists are not yet shortened by truncate(). Stores them in worker.neighbors and returns their number.
  std::uint32_t find(std::uint32_t slot, const CellSubset& points, Worker& worker) const;
  /// Shortens worker.neighbors, the lists of `points`, by the rule of the plan's neighbourhood, if it has one.
  void truncate(const WindowCell& cell, const CellSubset& points, Worker& worker) const;

  /// Adds to worker.named the slots of all cells to which `lists` refer. The lists belong to the points from `first`
  /// on; lists of deferred points do not count.
  static void note_references(const WindowCell& cell, std::uint32_t first, const CellNeighbors& lists, Worker& worker);
  /// Moves worker.named to cell.refers_to, so that the window keeps the named cells until `cell` is finished.
  static void hold_references(WindowCell& cell, Worker& worker);

  /// Stores a copy of the lists in the cell if memory allows. Returns whether the copy was stored.
  bool keep(WindowCell& cell, const CellNeighbors& found) const;
  void release(WindowCell& cell) const;

 private:
  PointColumns own(const WindowCell& cell, const CellSubset& points, Worker& worker) const;

  const SweepPlan& plan_;
  const CellSet& cells_;
  ListMemory memory_;
  std::uint64_t point_bytes_;                     ///< window_point_bytes(): bytes of a point in the window
  mutable std::atomic<std::uint64_t> bytes_ = 0;  ///< bytes of all stored lists
};

}  // namespace pointsweep
