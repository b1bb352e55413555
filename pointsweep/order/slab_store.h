// SPDX-License-Identifier: MIT
/// Where the working records of the ordered stream wait for the sweep: in memory, or spilled to one temporary file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace pointsweep {

class TempFolder;

/// `slabs` growing lists of fixed-size records. append() fills blocks of `block_bytes`; full blocks stay in memory or go to
/// the spill file in large sequential writes. Within a slab the stored order never changes after finish().
class SlabStore {
 public:
  /// `spill` null: everything stays in memory. Otherwise memory is slabs * block_bytes while filling, none after finish().
  SlabStore(std::size_t slabs, std::size_t record_bytes, std::size_t block_bytes, const TempFolder* spill);
  ~SlabStore();

  /// Appends whole records to a slab. Thread-safe.
  void append(std::size_t slab, std::span<const std::byte> records);
  /// No append() after it. Flushes what is buffered.
  void finish();

  std::uint64_t count(std::size_t slab) const;
  /// Copies records [first, first + out.size()/record_bytes) of the slab. Thread-safe after finish().
  void read(std::size_t slab, std::uint64_t first, std::span<std::byte> out) const;
  /// Bytes written to the spill file so far.
  std::uint64_t spilled_bytes() const;
  /// Bytes of memory held now.
  std::uint64_t memory_bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pointsweep
