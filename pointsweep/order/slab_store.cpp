// SPDX-License-Identifier: MIT
#include "pointsweep/order/slab_store.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <deque>
#include <mutex>
#include <optional>

#include "pointsweep/cancellation.h"
#include "pointsweep/order/block_pool.h"

namespace pointsweep {
namespace {

/// A run of records of one slab: in memory, or at `offset` of the spill file.
struct Block {
  std::uint64_t first = 0;  ///< index in the slab of its first record
  std::byte* memory = nullptr;
  std::uint64_t offset = 0;
};

struct SlabList {
  std::mutex mutex;
  std::vector<Block> blocks;
  std::size_t released = 0;   ///< of `blocks`, from the first on
  std::byte* open = nullptr;  ///< the block being filled; the last of `blocks` unless spilling
  std::size_t open_bytes = 0;
  std::uint64_t count = 0;

  /// Behind the last record of a block.
  std::uint64_t end_of(std::size_t block) const { return block + 1 < blocks.size() ? blocks[block + 1].first : count; }
};

}  // namespace

struct SlabStore::State {
  State(std::size_t record_size, std::size_t wanted_block_bytes)
      : record_bytes(record_size),
        block_bytes(std::max<std::size_t>(1, wanted_block_bytes / record_size) * record_size),
        pool(block_bytes) {}

  /// A full (or last) buffer of a spilling slab on its way to the file.
  struct Outgoing {
    std::byte* buffer = nullptr;
    std::size_t bytes = 0;
    std::uint64_t offset = 0;
  };

  void open_block(SlabList& list) {
    list.open = pool.take();
    list.open_bytes = 0;
    if (!file) list.blocks.push_back({list.count, list.open, 0});
  }

  /// Takes the open buffer away and gives it a place in the file. Needs the lock of the list; write() does not.
  Outgoing close_block(SlabList& list) {
    const Outgoing out{list.open, list.open_bytes, place_of(list.open_bytes)};
    list.blocks.push_back({list.count - list.open_bytes / record_bytes, nullptr, out.offset});
    list.open = nullptr;
    return out;
  }

  /// Of a full block that was released, if there is one: to punch a hole for it instead takes milliseconds once its
  /// bytes are on the disk, and a run under a small budget has a million blocks.
  std::uint64_t place_of(std::size_t bytes) {
    const std::scoped_lock lock(free_mutex);
    if (bytes < block_bytes || free_places.empty()) return file->reserve(bytes);
    const std::uint64_t place = free_places.back();
    free_places.pop_back();
    return place;
  }

  void give_back(const Block& block, std::size_t bytes) {
    if (!file) return pool.give_back(block.memory);
    const std::scoped_lock lock(free_mutex);
    if (bytes == block_bytes) free_places.push_back(block.offset);
  }

  void write(const Outgoing& out) {
    file->write(out.offset, {out.buffer, out.bytes});
    pool.give_back(out.buffer);
  }

  std::size_t record_bytes, block_bytes;
  std::deque<SlabList> lists;
  BlockPool pool;
  std::optional<SpillFile> file;
  std::mutex free_mutex;
  std::vector<std::uint64_t> free_places;  ///< in the file, of a full block each
};

SlabStore::SlabStore(std::size_t slabs, std::size_t record_bytes, std::size_t block_bytes, const SpillPlace& spill)
    : state_(std::make_unique<State>(record_bytes, block_bytes)) {
  if (spill) state_->file.emplace(spill);
  add_slabs(slabs);
}

SlabStore::SlabStore(Unpacker& packed, std::size_t record_bytes, std::size_t block_bytes, const SpillPlace& kept)
    : state_(std::make_unique<State>(record_bytes, block_bytes)) {
  state_->file.emplace(kept, packed.get<std::uint64_t>());
  add_slabs(packed.get<std::uint64_t>());
  for (SlabList& list : state_->lists) {
    list.count = packed.get<std::uint64_t>();
    list.blocks = packed.get_vector<Block>();
  }
}

SlabStore::~SlabStore() = default;

std::size_t SlabStore::add_slabs(std::size_t slabs) {
  const std::size_t first = state_->lists.size();
  for (std::size_t i = 0; i < slabs; ++i) state_->lists.emplace_back();
  return first;
}

void SlabStore::append(std::size_t slab, std::span<const std::byte> records) {
  State& s = *state_;
  assert(records.size() % s.record_bytes == 0);
  stop_if_cancelled();
  SlabList& list = s.lists[slab];
  std::unique_lock lock(list.mutex);
  while (!records.empty()) {
    if (list.open == nullptr) s.open_block(list);
    const std::size_t bytes = std::min(records.size(), s.block_bytes - list.open_bytes);
    std::memcpy(list.open + list.open_bytes, records.data(), bytes);
    list.open_bytes += bytes;
    list.count += bytes / s.record_bytes;
    records = records.subspan(bytes);
    if (list.open_bytes < s.block_bytes) continue;
    if (!s.file) {
      list.open = nullptr;
      continue;
    }
    const State::Outgoing out = s.close_block(list);
    lock.unlock();  // others go on filling the slab while this thread waits for the disk
    s.write(out);
    lock.lock();
  }
}

void SlabStore::flush() {
  State& s = *state_;
  for (SlabList& list : s.lists)
    if (s.file && list.open != nullptr) s.write(s.close_block(list));
}

void SlabStore::pack(Packer& out) const {
  out.put(state_->file->end());
  out.put<std::uint64_t>(state_->lists.size());
  for (const SlabList& list : state_->lists) {
    out.put(list.count);
    out.put(list.blocks);
  }
}

void SlabStore::finish() {
  State& s = *state_;
  flush();
  for (SlabList& list : s.lists) {
    list.open = nullptr;
    list.blocks.shrink_to_fit();
  }
  if (s.file) s.pool.clear();
}

void SlabStore::release_before(std::size_t slab, std::uint64_t record) {
  State& s = *state_;
  SlabList& list = s.lists[slab];
  for (; list.released < list.blocks.size() && list.end_of(list.released) <= record; ++list.released) {
    const Block& block = list.blocks[list.released];
    s.give_back(block, (list.end_of(list.released) - block.first) * s.record_bytes);
  }
}

void SlabStore::release(std::size_t slab) {
  SlabList& list = state_->lists[slab];
  release_before(slab, list.count);
  list.blocks = std::vector<Block>();
  list.released = 0;
  list.open = nullptr;
  list.count = 0;
}

std::uint64_t SlabStore::count(std::size_t slab) const { return state_->lists[slab].count; }

void SlabStore::read(std::size_t slab, std::uint64_t first, std::span<std::byte> out) const {
  const State& s = *state_;
  const SlabList& list = s.lists[slab];
  assert(first + out.size() / s.record_bytes <= list.count);
  auto block = std::upper_bound(list.blocks.begin(), list.blocks.end(), first,
                                [](std::uint64_t index, const Block& b) { return index < b.first; });
  for (; !out.empty(); ++block) {
    stop_if_cancelled();
    const Block& b = block[-1];
    const std::uint64_t end = block == list.blocks.end() ? list.count : block->first;
    const std::uint64_t skip = (first - b.first) * s.record_bytes;
    const std::size_t bytes = std::min<std::uint64_t>(out.size(), (end - first) * s.record_bytes);
    if (s.file)
      s.file->read(b.offset + skip, out.first(bytes));
    else
      std::memcpy(out.data(), b.memory + skip, bytes);
    out = out.subspan(bytes);
    first = end;
  }
}

std::uint64_t SlabStore::spilled_bytes() const { return state_->file ? state_->file->written_bytes() : 0; }

std::uint64_t SlabStore::memory_bytes() const {
  std::uint64_t bytes = state_->pool.taken_bytes();
  for (const SlabList& list : state_->lists) bytes += sizeof(SlabList) + list.blocks.capacity() * sizeof(Block);
  return bytes;
}

}  // namespace pointsweep
