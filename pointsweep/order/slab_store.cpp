// SPDX-License-Identifier: MIT
#include "pointsweep/order/slab_store.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <deque>
#include <mutex>
#include <optional>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/order/page_memory.h"

namespace pointsweep {
namespace {

constexpr Encoding kStoreEncoding{"record lists", 1};

/// A run of records of one slab: in memory, or at `offset` of the spill file.
struct Block {
  std::uint64_t first = 0;  ///< index in the slab of the first record of the block
  std::byte* memory = nullptr;
  std::uint64_t offset = 0;
};

struct SlabList {
  std::mutex mutex;
  std::vector<Block> blocks;
  std::size_t released = 0;   ///< number of leading `blocks` that are released
  std::byte* open = nullptr;  ///< the block being filled; the last of `blocks` unless spilling
  std::size_t open_bytes = 0;
  std::uint64_t count = 0;

  /// Returns the number of the record after the last record of a block.
  std::uint64_t end_of(std::size_t block) const { return block + 1 < blocks.size() ? blocks[block + 1].first : count; }
};

}  // namespace

struct SlabStore::State {
  State(std::size_t record_size, std::size_t wanted_block_bytes)
      : record_bytes(record_size),
        block_bytes(std::max<std::size_t>(1, wanted_block_bytes / record_size) * record_size),
        pool(block_bytes) {}

  /// A full (or last) buffer of a spilled slab on its way to the file.
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

  /// Detaches the open buffer of a list and assigns a place in the file to it. The caller holds the mutex of the list,
  /// unless no other thread uses the store; write() needs no mutex.
  Outgoing close_block(SlabList& list) {
    const Outgoing out{list.open, list.open_bytes, place_of(list.open_bytes)};
    list.blocks.push_back({list.count - list.open_bytes / record_bytes, nullptr, out.offset});
    list.open = nullptr;
    return out;
  }

  /// Returns an offset in the file for `bytes` bytes. A full block gets the place of a released full block, if any.
  /// Punching a hole in the file for each released block instead would take milliseconds per block, and a run with a
  /// small budget has a million blocks.
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

  /// Calls use(block, bytes to skip in it, bytes) for the blocks that contain `bytes` bytes from record `first` on.
  template <class Use>
  void for_each_part(std::size_t slab, std::uint64_t first, std::size_t bytes, Use use) const {
    const SlabList& list = lists[slab];
    auto after = std::ranges::upper_bound(list.blocks, first, {}, &Block::first);
    for (std::size_t left = bytes; left > 0; ++after) {
      const Block& block = after[-1];
      const std::uint64_t end = after == list.blocks.end() ? list.count : after->first;
      const std::size_t part = std::min<std::uint64_t>(left, (end - first) * record_bytes);
      use(block, (first - block.first) * record_bytes, part);
      left -= part;
      first = end;
    }
  }

  std::size_t record_bytes, block_bytes;
  std::deque<SlabList> lists;
  BlockPool pool;
  std::optional<SpillFile> file;
  std::mutex free_mutex;
  std::vector<std::uint64_t> free_places;  ///< offsets in the file, each with room for a full block
};

SlabStore::SlabStore(std::size_t slabs, std::size_t record_bytes, std::size_t block_bytes, const SpillPlace& spill)
    : state_(std::make_unique<State>(record_bytes, block_bytes)) {
  if (spill) state_->file.emplace(spill).expect_scattered_reads();
  add_slabs(slabs);
}

SlabStore::SlabStore(Decoder& in, std::size_t record_bytes, std::size_t block_bytes, const SpillPlace& kept)
    : state_(std::make_unique<State>(record_bytes, block_bytes)) {
  in.begin(kStoreEncoding);
  state_->file.emplace(kept, in.get<std::uint64_t>()).expect_scattered_reads();
  add_slabs(in.get_count());
  for (SlabList& list : state_->lists) {
    list.count = in.get<std::uint64_t>();
    list.blocks = in.get_list<Block>([&] { return Block{in.get<std::uint64_t>(), nullptr, in.get<std::uint64_t>()}; });
    const bool is_whole =
        list.blocks.empty() ? list.count == 0 : list.blocks.front().first == 0 && list.blocks.back().first < list.count;
    if (!is_whole || !std::ranges::is_sorted(list.blocks, {}, &Block::first))
      fail("The blocks of a spilled list of records are damaged.");
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
    lock.unlock();  // other threads continue to fill the slab while this thread waits for the disk
    s.write(out);
    lock.lock();
  }
}

void SlabStore::flush() {
  State& s = *state_;
  for (SlabList& list : s.lists)
    if (s.file && list.open != nullptr) s.write(s.close_block(list));
}

void SlabStore::encode(Encoder& out) const {
  out.begin(kStoreEncoding);
  out.put<std::uint64_t>(state_->file->end());
  out.put_list(state_->lists, [&](const SlabList& list) {
    out.put<std::uint64_t>(list.count);
    out.put_list(list.blocks, [&](const Block& block) {
      out.put<std::uint64_t>(block.first);
      out.put<std::uint64_t>(block.offset);
    });
  });
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

/// Announces all reads to the system first, since a slab can have hundreds of blocks far apart in the file.
void SlabStore::read(std::size_t slab, std::uint64_t first, std::span<std::byte> out) const {
  const State& s = *state_;
  assert(first + out.size() / s.record_bytes <= s.lists[slab].count);
  if (s.file) {
    s.for_each_part(slab, first, out.size(), [&](const Block& block, std::uint64_t skip, std::size_t bytes) {
      s.file->will_read(block.offset + skip, bytes);
    });
  }
  s.for_each_part(slab, first, out.size(), [&](const Block& block, std::uint64_t skip, std::size_t bytes) {
    stop_if_cancelled();
    if (s.file)
      s.file->read(block.offset + skip, out.first(bytes));
    else
      std::memcpy(out.data(), block.memory + skip, bytes);
    out = out.subspan(bytes);
  });
}

std::size_t SlabStore::slabs() const { return state_->lists.size(); }

std::uint64_t SlabStore::spilled_bytes() const { return state_->file ? state_->file->written_bytes() : 0; }

std::uint64_t SlabStore::memory_bytes() const {
  std::uint64_t bytes = state_->pool.taken_bytes();
  for (const SlabList& list : state_->lists) bytes += sizeof(SlabList) + list.blocks.capacity() * sizeof(Block);
  return bytes;
}

}  // namespace pointsweep
