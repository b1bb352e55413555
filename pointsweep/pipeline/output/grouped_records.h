// SPDX-License-Identifier: MIT
/// A stable distribution of records into groups in bounded memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/points/scratch.h"

namespace pointsweep {

/// Collects records in any order and returns them group by group. When the memory is full, its records are sorted by
/// group and written to scratch as a run. At the end, all runs are read at the same time, each in sequence. So records
/// are written and read once, for any number of groups; nothing is written if all records fit.
class GroupedRecords {
 public:
  /// `expected`: about the number of records; memory for so many is reserved first. `memory_bytes`: limit for the
  /// memory of this object; with many runs, at least 4 kB for each run are used.
  GroupedRecords(std::size_t record_bytes, std::uint64_t expected, std::uint64_t memory_bytes,
                 MakeScratch make_scratch);

  /// Appends a record to a group. Returns its place, which the caller fills before the next call.
  std::byte* add(std::uint32_t group);
  /// Calls `use` with whole records: groups in ascending order, records of a group in the order in which they came, in
  /// pieces of at most a megabyte, or one record. Must be called once, after the last record.
  void for_each(const std::function<void(std::uint32_t group, std::span<const std::byte> records)>& use);

 private:
  using Use = std::function<void(std::uint32_t group, std::span<const std::byte> records)>;
  class Run;
  void put_run_aside();
  void for_each_held(const Use& use) const;
  std::size_t held() const { return group_of_.size(); }

  std::size_t record_bytes_;
  std::uint64_t expected_;
  std::size_t capacity_;  ///< number of records in a full run
  std::uint64_t memory_bytes_;
  MakeScratch make_scratch_;
  std::vector<std::byte> records_;       ///< records of the run that is being filled
  std::vector<std::uint32_t> group_of_;  ///< group of each record in records_
  std::unique_ptr<Scratch> scratch_;     ///< null until a run is written
  std::vector<std::uint64_t> run_ends_;  ///< offset in the scratch where each run ends
};

}  // namespace pointsweep
