// SPDX-License-Identifier: MIT
/// Objects in the network, opened for reading at any place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/storage/remote/remote_service.h"

namespace pointsweep {

/// The bytes that all open objects keep of what was read. A run plans with them (open_input_bytes()).
inline constexpr std::uint64_t kRemoteCacheBytes = 16u << 20;

/// One version of an object. What is read together is asked for together: the first request brings 64 kB, requests
/// that follow one another grow to 2 MB, and a caller that knows which bytes it will read says so. Thread-safe.
class RemoteObject {
 public:
  /// Opens the object, which costs one request unless it is open already. Throws Error if that is not possible.
  static std::shared_ptr<RemoteObject> open(const std::string& url);
  ~RemoteObject();
  RemoteObject(const RemoteObject&) = delete;
  RemoteObject& operator=(const RemoteObject&) = delete;

  const std::string& url() const { return url_; }
  const RemoteVersion& version() const { return *version_; }

  /// Reads as many bytes as there are up to the end, at most bytes.size(), and returns how many. Throws Error where the
  /// object has changed since it was opened.
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes);
  /// Says that [begin, end) will be read from `begin` on, so that one request brings it.
  void will_read(std::uint64_t begin, std::uint64_t end);

 private:
  struct Block;
  /// A place up to which bytes were read one after another.
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
  // Under the lock of the cache.
  std::map<std::uint64_t, std::shared_ptr<Block>> blocks_;  ///< by their first bytes; they do not overlap
  std::vector<Run> runs_;
  std::map<std::uint64_t, std::uint64_t> said_;  ///< ends by begins, of will_read()
};

}  // namespace pointsweep
