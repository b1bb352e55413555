// SPDX-License-Identifier: MIT
/// Puts a sweep back to where another process has left it (docs/adr/0008).
///
/// The cells that were in the window come back to it, and the boxes of dropped ones to what lies frontier. Where later
/// steps look at what earlier ones made, the last slabs are read again and their cells go through all steps once more,
/// for others to look at; what had been handed over is not handed over again. No value depends on how far this goes
/// back: what cannot be certified is recalled.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "pointsweep/sweep/slab_loader.h"
#include "pointsweep/sweep/sweep_progress.h"
#include "pointsweep/sweep/window.h"

namespace pointsweep {

class SweepRestart {
 public:
  /// What is given must outlive it.
  SweepRestart(const SweepProgress& from, const Stream& stream, const SweepPlan& plan);

  /// Slabs are to be read from here on, some of them for the second time.
  std::uint32_t first_slab() const { return first_slab_; }
  /// Everything of the slabs before the first.
  void restore(const SlabLoader& loader, Window& window, Frontier& frontier, Sink& sink) const;
  /// A slab read again, before its cells go into the window: marks those that had been finished, and tells the sink.
  void prepare(std::uint32_t slab, LoadedSlab& loaded, Sink& sink) const;

 private:
  std::uint32_t slab_to_begin_with() const;
  bool was_in_window(std::uint32_t slab) const;
  void mark(WindowCell& cell) const;
  void tell(std::uint32_t slab, std::vector<std::byte> records, std::uint64_t unfinished, Sink& sink) const;

  const SweepProgress& from_;
  const Stream& stream_;
  const SweepPlan& plan_;
  std::uint32_t first_slab_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, WindowedCell> window_;  ///< by slab and number
  std::map<std::uint32_t, std::vector<std::uint32_t>> deferred_;            ///< by slab: indices in it
};

}  // namespace pointsweep
