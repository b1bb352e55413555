// SPDX-License-Identifier: MIT
/// Requests to servers of HTTP and to buckets. The only file that knows the library for them, which a build may lack.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace pointsweep {

/// What tells one version of an object from another.
struct RemoteVersion {
  std::uint64_t size = 0;
  std::int64_t seconds = 0;       ///< of its last change, since 1970; 0 where the server does not say
  std::uint32_t nanoseconds = 0;  ///< of that second
  std::string etag = {};          ///< empty where there is none

  /// Returns whether another look has found this version.
  bool is(const RemoteVersion& other) const;
  /// "2400312 bytes, ETag "6805f2cfc46c0f04"", or the time where there is no ETag.
  std::string text() const;
};

struct RemoteEntry {
  std::string url;
  std::uint64_t size;
};

/// Requests of this process, without those that were made again.
struct RemoteTraffic {
  std::uint64_t requests = 0;
  std::uint64_t bytes_read = 0;
};

// Each of these throws Error: the URL, what happened, and what to do. They take about half a minute to fail where a
// server does not answer.

/// Returns the version of an object; nothing if there is none.
std::optional<RemoteVersion> look_at(const std::string& url);
/// Reads up to bytes.size() bytes from `offset` on, fewer at the end of the object. Returns how many. Throws for an
/// object that is not the `expected` one; without any, sets `expected`.
std::size_t read_remote(const std::string& url, std::optional<RemoteVersion>& expected, std::uint64_t offset,
                        std::span<std::byte> bytes);
/// Returns the objects in a folder, whose URL ends in '/', and with `recursive` those in its folders.
std::vector<RemoteEntry> list_remote(const std::string& folder, bool recursive);
/// Makes an object of a file. It is visible when it is complete. Throws if it exists, unless `overwrite`.
void upload(const std::string& url, const std::filesystem::path& file, bool overwrite);
/// Makes an object of bytes, at once.
void put_remote(const std::string& url, std::span<const std::byte> bytes, bool overwrite);
/// Returns false, and writes nothing, where the object exists.
bool put_remote_if_absent(const std::string& url, std::span<const std::byte> bytes);
/// Removes an object, if there is one.
void remove_remote(const std::string& url);

/// Throws unless objects can be written there.
void require_writable_url(const std::string& url);

RemoteTraffic remote_traffic();

}  // namespace pointsweep
