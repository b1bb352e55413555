// SPDX-License-Identifier: MIT
/// Objects on servers, read at any offset, and threads that wait for servers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/storage/remote/remote_service.h"

namespace pointsweep {

/// Most bytes that the cache of all open objects holds; while blocks that are being loaded fill it, each further block
/// exceeds it by up to 64 kB. The memory plan of a run counts them (open_input_bytes()).
inline constexpr std::uint64_t kRemoteCacheBytes = 16u << 20;

/// One version of an object. Reads are joined into few requests: the first request brings 64 kB, successive requests
/// grow to 2 MB, and will_read() announces a range. Thread-safe.
class RemoteObject {
 public:
  /// Opens the object with one request. For an object that is already open, a request looks for a newer version, at
  /// most every 2 seconds. Throws Error on failure.
  static std::shared_ptr<RemoteObject> open(const std::string& url);
  ~RemoteObject();
  RemoteObject(const RemoteObject&) = delete;
  RemoteObject& operator=(const RemoteObject&) = delete;

  const std::string& url() const { return url_; }
  const RemoteVersion& version() const { return *version_; }

  /// Reads up to bytes.size() bytes, fewer at the end of the object, and returns their number. Throws Error if the
  /// object has changed since it was opened.
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes);
  /// Announces that [begin, end) will be read, from `begin` on, so that one request brings the range, or each 2 MB of a
  /// larger range.
  void will_read(std::uint64_t begin, std::uint64_t end);

 private:
  struct Block;
  /// Successive requests without a gap: the offset after the last request, and the number of bytes of all of them.
  struct Run {
    std::uint64_t end = 0, length = 0;
  };
  struct Cache;
  static Cache& cache();
  static bool make_room(std::uint64_t bytes);

  explicit RemoteObject(std::string url);
  std::shared_ptr<Block> block_at(std::uint64_t offset, std::uint64_t wanted);
  std::shared_ptr<Block> known_block(std::uint64_t offset) const;
  std::uint64_t begin_of_request(std::uint64_t offset) const;
  std::uint64_t end_of_request(std::uint64_t offset, std::uint64_t wanted);
  void load(Block& block);
  void forget(const Block& block);

  std::string url_;
  std::optional<RemoteVersion> version_;
  // The lock of the cache guards the members below.
  std::map<std::uint64_t, std::shared_ptr<Block>> blocks_;  ///< blocks, without overlap, by their first offset
  std::vector<Run> runs_;
  std::map<std::uint64_t, std::uint64_t> said_;  ///< ranges of will_read(): the end of each range by its first offset
};

/// Calls body(i), which sends requests to servers, for each i < count, on up to 16 threads. There may be more threads
/// than cores, since each thread waits most of the time. If bodies throw, rethrows the exception of the lowest i.
void for_each_waiting(std::size_t count, const std::function<void(std::size_t i)>& body);

}  // namespace pointsweep
