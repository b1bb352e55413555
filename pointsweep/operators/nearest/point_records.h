// SPDX-License-Identifier: MIT
/// Attributes of a set of points that does not fit in memory: stored in temporary storage (Scratch), with some blocks
/// in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/points/scratch.h"

namespace pointsweep {

/// Records of one length, numbered from 0 in the order of arrival. Successive requests should be for records near each
/// other.
class PointRecords {
 public:
  /// A number that means no record.
  static constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();

  /// `record_bytes`: bytes of a record, > 0. `memory_bytes`: limit for the blocks in memory; 64 blocks may exceed it
  /// (least_bytes()).
  PointRecords(std::size_t record_bytes, std::uint64_t memory_bytes, std::unique_ptr<Scratch> scratch);
  /// Adds whole records. Must not be called after finish().
  void add(std::span<const std::byte> records);
  /// Ends the records. Must be called after the last record and before the first gather().
  void finish();
  std::uint64_t count() const { return count_; }

  /// Copies record numbers[i] to place i of `to`, on all threads. Does not write place i if numbers[i] is kNone.
  void gather(std::span<const std::uint64_t> numbers, std::span<std::byte> to);

  static std::uint64_t least_bytes(std::size_t record_bytes);

 private:
  void load(std::span<const std::size_t> blocks);
  void end_block();

  std::size_t record_bytes_, most_loaded_;
  std::unique_ptr<Scratch> scratch_;
  std::vector<std::byte> block_;                ///< the block being filled
  std::uint64_t count_ = 0;                     ///< number of records in scratch
  std::vector<std::vector<std::byte>> blocks_;  ///< records of each block; empty if the block is not in memory
  std::vector<std::size_t> loaded_;
};

}  // namespace pointsweep
