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
  /// Spilling, memory is slabs * block_bytes while filling, none after finish(). `block_bytes` is rounded down to whole
  /// records, but never below one.
  SlabStore(std::size_t slabs, std::size_t record_bytes, std::size_t block_bytes, const SpillPlace& spill);
  /// Decodes a store whose records are in the file `kept`.
  SlabStore(Decoder& in, std::size_t record_bytes, std::size_t block_bytes, const SpillPlace& kept);
  ~SlabStore();

  /// Adds `slabs` empty slabs and returns the number of the first. No other function may run meanwhile.
  std::size_t add_slabs(std::size_t slabs);
  /// Appends whole records to a slab. Thread-safe.
  void append(std::size_t slab, std::span<const std::byte> records);
  /// Flushes the buffers. After it, append() may be called only for slabs that add_slabs() makes later.
  void finish();
  /// Writes everything that was appended, and that encode() refers to, to the kept file. No thread may call append()
  /// meanwhile.
  void flush();
  /// Encodes the places of the records in the kept file.
  void encode(Encoder& out) const;
  /// Gives the space of blocks of a finished slab that end before `record` to blocks that will be filled, in memory as
  /// in the file; no thread may be reading it, or ever read records before that one again. Others may append to other
  /// slabs.
  void release_before(std::size_t slab, std::uint64_t record);
  /// Forgets the records of a slab and gives their space back. No thread may be reading it.
  void release(std::size_t slab);

  std::uint64_t count(std::size_t slab) const;
  /// Copies records [first, first + out.size()/record_bytes) of a finished slab. Thread-safe.
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
