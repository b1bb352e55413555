// SPDX-License-Identifier: MIT
/// Any number of records with their levels of detail, in bounded memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "pointsweep/geometry.h"
#include "pointsweep/levels/curve_points.h"
#include "pointsweep/levels/curve_records.h"
#include "pointsweep/levels/level_choice.h"
#include "pointsweep/levels/level_grid.h"
#include "pointsweep/points/scratch.h"

namespace pointsweep {

/// Returns the least memory in bytes that LevelledRecords needs for `threads` threads.
std::uint64_t least_level_bytes(unsigned threads);

/// Returns whether LevelledRecords with `memory_bytes` of memory writes `bytes` bytes of records to a scratch.
bool puts_records_aside(std::uint64_t bytes, std::uint64_t memory_bytes);

class LevelledRecords {
 public:
  /// Takes records that begin with a GridPoint. `memory_bytes`: limit for the memory of this object. Without `files`,
  /// all records stay in memory, even beyond the limit.
  LevelledRecords(std::size_t record_bytes, std::uint64_t memory_bytes, const MakeScratch& files);

  void add(std::span<const std::byte> records) { records_.add(records); }

  /// Chooses the levels. Must be called once, after the last add() and before the functions below. `scale`: the length
  /// of a step on each axis, in units of the cloud.
  void choose(Vec3 scale);
  const LevelGrid& grid() const { return *grid_; }
  /// Returns the spacing of the points of depth 0, in units of the cloud, like `scale`.
  double spacing() const { return spacing_ * grid_->unit(); }

  using Use = std::function<void(const CurveKey& key, int depth, const std::byte* record)>;
  /// Calls `use` with all records in Morton order. Must be called only once.
  void for_each(const Use& use);
  /// Returns the memory and files that are left for scratches of the caller.
  ScratchRoom& room() { return room_; }

 private:
  std::size_t record_bytes_;
  std::uint64_t memory_;
  CurveRecords records_;
  ScratchRoom room_;
  std::optional<LevelGrid> grid_;
  std::optional<CurvePoints> points_;
  std::optional<LevelChoice> choice_;
  double spacing_ = 0;
};

}  // namespace pointsweep
