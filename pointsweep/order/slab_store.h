// SPDX-License-Identifier: MIT
/// Stores the working records of the ordered stream until the sweep reads them: in memory, or spilled to one temporary
/// file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/storage/encoding.h"
#include "pointsweep/storage/local/spill_file.h"

namespace pointsweep {

/// `slabs` growing lists of fixed-size records. append() fills blocks of `block_bytes`; full blocks stay in memory or
/// go to the spill file in large sequential writes. Within a slab the stored order never changes after finish().
class SlabStore {
 public:
  /// A store that spills takes up to slabs * block_bytes of memory for records until finish(), and none afterwards.
  /// `block_bytes` is rounded down to whole records, at least one.
  SlabStore(std::size_t slabs, std::size_t record_bytes, std::size_t block_bytes, const SpillPlace& spill);
  /// Decodes a store whose records are in the file `kept`.
  SlabStore(Decoder& in, std::size_t record_bytes, std::size_t block_bytes, const SpillPlace& kept);
  ~SlabStore();

  /// Adds `slabs` empty slabs and returns the number of the first. No other function may run at the same time.
  std::size_t add_slabs(std::size_t slabs);
  /// Appends whole records to a slab. Thread-safe.
  void append(std::size_t slab, std::span<const std::byte> records);
  /// Flushes the buffers. Later calls of append() may only name slabs that add_slabs() adds later.
  void finish();
  /// Writes to the kept file all records to which encode() refers. No thread may call append() at the same time.
  void flush();
  /// Encodes the places of the records in the kept file.
  void encode(Encoder& out) const;
  /// Frees the blocks of a finished slab that end before `record`, in memory or in the file, for reuse by other blocks.
  /// No thread may be reading the slab, and no earlier record of it may be read again. Other threads may append to
  /// other slabs.
  void release_before(std::size_t slab, std::uint64_t record);
  /// Frees all records of a slab. No thread may be reading it.
  void release(std::size_t slab);

  std::size_t slabs() const;
  std::uint64_t count(std::size_t slab) const;
  /// Copies records [first, first + out.size()/record_bytes) of a finished slab. Thread-safe.
  void read(std::size_t slab, std::uint64_t first, std::span<std::byte> out) const;
  /// Returns the number of bytes written to the spill file so far.
  std::uint64_t spilled_bytes() const;
  /// Returns the bytes of memory in use.
  std::uint64_t memory_bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pointsweep
