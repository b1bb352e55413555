// SPDX-License-Identifier: MIT
/// Stores the working records (working_record.h) of the stream until the sweep reads them: in memory, or spilled to one
/// file, which is temporary or a kept file (SpillPlace), from which a resumed run decodes the store.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "pointsweep/storage/encoding.h"
#include "pointsweep/storage/local/spill_file.h"

namespace pointsweep {

/// Growing lists of fixed-size records, here called slabs. append() fills blocks of `block_bytes`; full blocks stay in
/// memory or go to the spill file in one write each. finish() fixes the order of records in a slab.
class SlabStore {
 public:
  /// A store that spills takes about slabs * block_bytes of memory for records until finish(), and none afterwards.
  /// `block_bytes` is rounded down to whole records, at least one.
  SlabStore(std::size_t slabs, std::size_t record_bytes, std::size_t block_bytes, const SpillPlace& spill);
  /// Decodes a store whose records are in the kept file `kept`.
  SlabStore(Decoder& in, std::size_t record_bytes, std::size_t block_bytes, const SpillPlace& kept);
  ~SlabStore();

  /// Adds `slabs` empty slabs and returns the number of the first new slab. No other function may run at the same time.
  std::size_t add_slabs(std::size_t slabs);
  /// Appends whole records to a slab. Thread-safe.
  void append(std::size_t slab, std::span<const std::byte> records);
  /// Flushes the buffers. Later calls of append() may only name slabs that add_slabs() adds after finish().
  void finish();
  /// Writes all buffered records to the file, as encode() requires. No thread may call append() at the same time.
  void flush();
  /// Encodes where the kept file has the records. Must be called after flush() or finish().
  void encode(Encoder& out) const;
  /// Frees the blocks of a finished slab whose records all stand before `record`, so that other blocks can reuse the
  /// memory or the place in the file. No thread may be reading the slab, or read records before `record` later. Other
  /// threads may append to other slabs.
  void release_before(std::size_t slab, std::uint64_t record);
  /// Frees all records of a slab. No thread may be reading the slab.
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
