// SPDX-License-Identifier: MIT
/// Records in any order, given back group by group: a stable distribution in bounded memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/points/scratch.h"

namespace pointsweep {

/// What fills the memory is sorted by group and put aside as a run. At the end, the runs are read side by side, each in
/// sequence. So records are written and read once, however many groups there are; nothing is written if all fit.
class GroupedRecords {
 public:
  /// `expected` records come, or somewhat more. `memory_bytes` is for all that is held at once; where there are many
  /// runs, at least 4 kB for each are held.
  GroupedRecords(std::size_t record_bytes, std::uint64_t expected, std::uint64_t memory_bytes,
                 MakeScratch make_scratch);

  /// Appends a record to a group and returns its place, for the caller to fill before the next call.
  std::byte* add(std::uint32_t group);
  /// Calls `use` with whole records: those of the least group first, those of a group in the order in which they came,
  /// in pieces of at most a megabyte, or one record. To be called once, after the last record.
  void for_each(const std::function<void(std::uint32_t group, std::span<const std::byte> records)>& use);

 private:
  using Use = std::function<void(std::uint32_t group, std::span<const std::byte> records)>;
  class Run;
  void put_run_aside();
  void for_each_held(const Use& use) const;
  std::size_t held() const { return group_of_.size(); }

  std::size_t record_bytes_;
  std::uint64_t expected_;
  std::size_t capacity_;  ///< records of a run
  std::uint64_t memory_bytes_;
  MakeScratch make_scratch_;
  std::vector<std::byte> records_;       ///< of the run that is being filled
  std::vector<std::uint32_t> group_of_;  ///< by record of that run
  std::unique_ptr<Scratch> scratch_;     ///< null as long as nothing is put aside
  std::vector<std::uint64_t> run_ends_;  ///< bytes of the scratch
};

}  // namespace pointsweep
