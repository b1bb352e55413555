// SPDX-License-Identifier: MIT
#include "pointsweep/storage/remote/remote_object.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <list>
#include <mutex>
#include <thread>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kFirstRequest = 64 << 10;
constexpr std::uint64_t kLargestRequest = 2 << 20;
constexpr std::size_t kMostRuns = 32;   ///< most runs of successive requests that an object remembers
constexpr std::size_t kMostSaid = 256;  ///< most ranges of will_read() that an object remembers

}  // namespace

/// Bytes [begin, end) of an object, in the cache.
struct RemoteObject::Block {
  RemoteObject* owner;
  std::uint64_t begin, end;
  std::unique_ptr<std::byte[]> bytes;
  bool is_loading = true;
  std::list<Block*>::iterator place = {};
};

/// The blocks of all objects of this process, and the objects that may be open.
struct RemoteObject::Cache {
  /// An object that may be open, and the time at which a server last confirmed its version.
  struct OpenObject {
    std::weak_ptr<RemoteObject> object;
    std::chrono::steady_clock::time_point seen;
  };

  std::mutex mutex;
  std::condition_variable loaded;
  std::map<std::string, OpenObject> objects;
  std::list<Block*> blocks;  ///< most recently read block first
  std::uint64_t bytes = 0;
};

RemoteObject::Cache& RemoteObject::cache() {
  static Cache& all = *new Cache;  // never destroyed: objects may outlive static variables
  return all;
}

RemoteObject::RemoteObject(std::string url) : url_(std::move(url)) {
  auto first = std::make_shared<Block>(Block{this, 0, 0, std::make_unique_for_overwrite<std::byte[]>(kFirstRequest)});
  const std::size_t got = read_remote(url_, version_, 0, std::span(first->bytes.get(), kFirstRequest));
  const std::lock_guard lock(cache().mutex);
  if (got == 0 || !make_room(kFirstRequest)) return;
  first->end = got;
  first->is_loading = false;
  first->place = cache().blocks.insert(cache().blocks.begin(), first.get());
  cache().bytes += got;
  runs_.push_back({got, got});
  blocks_.emplace(0, std::move(first));
}

RemoteObject::~RemoteObject() {
  const std::lock_guard lock(cache().mutex);
  while (!blocks_.empty()) forget(*blocks_.begin()->second);
  if (const auto known = cache().objects.find(url_); known != cache().objects.end() && known->second.object.expired())
    cache().objects.erase(known);
}

/// A newer version becomes a new RemoteObject; readers of the old object keep the old version.
std::shared_ptr<RemoteObject> RemoteObject::open(const std::string& url) {
  constexpr std::chrono::seconds kSeenLately(2);
  std::shared_ptr<RemoteObject> object;
  const auto now = std::chrono::steady_clock::now();
  {
    const std::lock_guard lock(cache().mutex);
    if (const auto known = cache().objects.find(url); known != cache().objects.end()) {
      object = known->second.object.lock();
      if (object && now - known->second.seen < kSeenLately) return object;
    }
  }
  if (object) {
    const std::optional<RemoteVersion> newest = look_at(url);
    if (!newest || !newest->is(object->version())) object.reset();
  }
  if (!object) object.reset(new RemoteObject(url));
  const std::lock_guard lock(cache().mutex);
  cache().objects[url] = {object, now};
  return object;
}

/// Removes a block from the cache. Only the thread that loads a block may remove the block before it is loaded. The
/// caller holds the lock of the cache.
void RemoteObject::forget(const Block& block) {
  cache().bytes -= block.end - block.begin;
  cache().blocks.erase(block.place);
  blocks_.erase(block.begin);
}

/// Removes least recently read blocks until `bytes` more fit. Returns whether they fit. The caller holds the lock of
/// the cache.
bool RemoteObject::make_room(std::uint64_t bytes) {
  std::list<Block*>& blocks = cache().blocks;
  for (auto block = blocks.end(); cache().bytes + bytes > kRemoteCacheBytes && block != blocks.begin();) {
    Block* const oldest = *--block;
    if (oldest->is_loading) continue;
    ++block;  // `block` stays valid: forget() erases the element before it
    oldest->owner->forget(*oldest);
  }
  return cache().bytes + bytes <= kRemoteCacheBytes;
}

/// Returns the block that holds the byte at `offset`; null if the cache has none. The caller holds the lock of the
/// cache.
std::shared_ptr<RemoteObject::Block> RemoteObject::known_block(std::uint64_t offset) const {
  const auto after = blocks_.upper_bound(offset);
  if (after == blocks_.begin()) return nullptr;
  const std::shared_ptr<Block>& block = std::prev(after)->second;
  return offset < block->end ? block : nullptr;
}

/// Returns the offset at which a request for the byte at `offset` begins: the first offset of an announced range if the
/// byte is among the first 64 kB of the range and no byte of the range up to `offset` is in the cache, else `offset`.
/// The caller holds the lock of the cache.
std::uint64_t RemoteObject::begin_of_request(std::uint64_t offset) const {
  const auto said = said_.upper_bound(offset);
  if (said == said_.begin()) return offset;
  const auto [begin, end] = *std::prev(said);
  const auto block = blocks_.upper_bound(offset);
  const bool is_kept = block != blocks_.begin() && std::prev(block)->second->end > begin;
  return offset < end && offset - begin < kFirstRequest && !is_kept ? begin : offset;
}

/// Returns the offset at which a request for `wanted` bytes from `offset` on ends, and adds the request to its run. The
/// caller holds the lock of the cache.
std::uint64_t RemoteObject::end_of_request(std::uint64_t offset, std::uint64_t wanted) {
  std::uint64_t bytes = std::max(wanted, kFirstRequest);
  const auto run = std::ranges::find(runs_, offset, &Run::end);
  const std::uint64_t before = run == runs_.end() ? 0 : run->length;
  const auto said = said_.upper_bound(offset);
  if (said != said_.begin() && offset < std::prev(said)->second)
    bytes = std::max(std::prev(said)->second - offset, before / 2);  // at most a third of the bytes may be unneeded
  else
    bytes = std::max(bytes, before);
  std::uint64_t end = offset + std::min(bytes, kLargestRequest);
  if (const auto next = blocks_.upper_bound(offset); next != blocks_.end()) end = std::min(end, next->first);
  end = std::min(end, version().size);
  const Run longer{end, before + (end - offset)};
  if (run != runs_.end()) runs_.erase(run);
  if (runs_.size() >= kMostRuns) runs_.erase(runs_.begin());
  runs_.push_back(longer);
  return end;
}

void RemoteObject::will_read(std::uint64_t begin, std::uint64_t end) {
  const std::lock_guard lock(cache().mutex);
  if (said_.size() >= kMostSaid) said_.clear();
  said_[begin] = end;
}

/// Requests the bytes of a block for which other threads may wait.
void RemoteObject::load(Block& block) {
  try {
    block.bytes = std::make_unique_for_overwrite<std::byte[]>(block.end - block.begin);
    const std::span<std::byte> bytes(block.bytes.get(), block.end - block.begin);
    if (read_remote(url_, version_, block.begin, bytes) < bytes.size())
      fail("{}: ends before byte {}; it has changed since it was opened, so run again once it is complete.", url_,
           block.end);
  } catch (...) {
    const std::lock_guard lock(cache().mutex);
    forget(block);
    cache().loaded.notify_all();
    throw;
  }
  const std::lock_guard lock(cache().mutex);
  block.is_loading = false;
  cache().loaded.notify_all();
}

/// Returns the block that holds the byte at `offset`; if the cache has none, loads a block for `wanted` bytes from
/// `offset` on.
std::shared_ptr<RemoteObject::Block> RemoteObject::block_at(std::uint64_t offset, std::uint64_t wanted) {
  std::shared_ptr<Block> block;
  {
    std::unique_lock lock(cache().mutex);
    while ((block = known_block(offset)) && block->is_loading) {
      cache().loaded.wait_for(lock, std::chrono::milliseconds(100));
      stop_if_cancelled();
    }
    std::list<Block*>& blocks = cache().blocks;
    if (block) {
      blocks.splice(blocks.begin(), blocks, block->place);
      return block;
    }
    wanted += offset - begin_of_request(offset);
    offset = begin_of_request(offset);
    std::uint64_t end = end_of_request(offset, wanted);
    if (!make_room(end - offset)) end = std::min(end, offset + kFirstRequest);
    block = std::make_shared<Block>(Block{this, offset, end, nullptr});
    block->place = blocks.insert(blocks.begin(), block.get());
    cache().bytes += end - offset;
    blocks_.emplace(offset, block);
  }
  load(*block);
  return block;
}

std::size_t RemoteObject::read_some(std::uint64_t offset, std::span<std::byte> bytes) {
  const std::uint64_t size = version().size;
  if (offset >= size) return 0;
  bytes = bytes.first(static_cast<std::size_t>(std::min<std::uint64_t>(bytes.size(), size - offset)));
  for (std::size_t done = 0; done < bytes.size();) {
    const std::shared_ptr<Block> block = block_at(offset + done, bytes.size() - done);
    const std::size_t n = std::min<std::uint64_t>(bytes.size() - done, block->end - (offset + done));
    std::memcpy(bytes.data() + done, block->bytes.get() + (offset + done - block->begin), n);
    done += n;
  }
  return bytes.size();
}

void for_each_waiting(std::size_t count, const std::function<void(std::size_t i)>& body) {
  constexpr std::size_t kMostThreads = 16;
  std::atomic<std::size_t> next = 0;
  FirstFailure failure;
  const auto work = [&, token = CancellationScope::current()] {
    const CancellationScope scope(token);
    for (std::size_t i = next++; i < count && !failure.makes_needless(i); i = next++)
      failure.note_from(i, [&] {
        stop_if_cancelled();
        body(i);
      });
  };
  std::vector<std::thread> others;
  for (std::size_t t = 1; t < std::min(count, kMostThreads); ++t) others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
  failure.rethrow();
}

}  // namespace pointsweep
