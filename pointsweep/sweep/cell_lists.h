// SPDX-License-Identifier: MIT
/// Neighbour lists of the cells of a window or a region: finds and shortens them, keeps those that later steps of a
/// sweep need as far as there is memory, and notes which cells they name.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

#include "pointsweep/sweep/window_cell.h"
#include "pointsweep/sweep/worker.h"

namespace pointsweep {

/// Adds the time until its end to `seconds`.
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
  /// Bytes for the cells of the window, lists included. Lists that later steps need and that do not fit are not kept; a
  /// later step finds equal lists again.
  std::uint64_t cells_bytes;
  /// Bytes for the lists that one thread works on; the list of a single point may take more. Larger lists of a cell are
  /// found, used and dropped for one run of its points after another.
  std::uint64_t lists_bytes;
};

/// Thread-safe for different cells, if each thread has its own worker.
class CellLists {
 public:
  CellLists(const SweepPlan& plan, const CellSet& cells, const ListMemory& memory)
      : plan_(plan), cells_(cells), memory_(memory), point_bytes_(window_point_bytes(plan)) {}

  /// Fills worker.reach2: how far each neighbourhood of the cell reaches. True if all lists were found on the way and
  /// are in worker.neighbors. Without a limit k the reach is the radius, and no search is needed to know it.
  bool find_reaches(std::uint32_t slot, Worker& worker) const;
  /// Finds the lists of the first of `points`, as many as the memory for them allows, in worker.neighbors, before the
  /// rule. Returns how many.
  std::uint32_t find(std::uint32_t slot, const CellSubset& points, Worker& worker) const;
  /// Applies the rule of the plan to worker.neighbors, the lists of `points`.
  void truncate(const WindowCell& cell, const CellSubset& points, Worker& worker) const;

  /// Notes in the worker which cells the lists name.
  static void note_references(const WindowCell& cell, std::uint32_t first, const CellNeighbors& lists, Worker& worker);
  /// The cells noted since the last call stay in the window until this cell is finished.
  static void hold_references(WindowCell& cell, Worker& worker);

  /// Keeps a copy in the cell if there is room.
  bool keep(WindowCell& cell, const CellNeighbors& found) const;
  void release(WindowCell& cell) const;

 private:
  PointColumns own(const WindowCell& cell, const CellSubset& points, Worker& worker) const;

  const SweepPlan& plan_;
  const CellSet& cells_;
  ListMemory memory_;
  std::uint64_t point_bytes_;                     ///< bytes of a point in the window, with its columns
  mutable std::atomic<std::uint64_t> bytes_ = 0;  ///< bytes of all lists kept now
};

}  // namespace pointsweep
