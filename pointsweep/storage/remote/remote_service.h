// SPDX-License-Identifier: MIT
/// Requests to HTTP servers and to buckets. Only this pair of files uses the client library, which a build may lack.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace pointsweep {

/// The size, time and ETag that distinguish versions of an object.
struct RemoteVersion {
  std::uint64_t size = 0;
  std::int64_t seconds = 0;       ///< time of the last change in seconds since 1970; 0 if the server does not state it
  std::uint32_t nanoseconds = 0;  ///< nanoseconds of the time of the last change
  std::string etag = {};          ///< ETag; empty if the server states none

  /// Returns whether `other` is the same version.
  bool is(const RemoteVersion& other) const;
  /// Returns a text like "2400312 bytes, ETag "6805f2cfc46c0f04"", with the time in place of the ETag if the server
  /// states none.
  std::string text() const;
};

struct RemoteEntry {
  std::string url;
  std::uint64_t size;
};

// Each function below throws Error on failure, with the URL, the cause and the remedy. If a server does not answer, the
// function fails after about half a minute.

/// Returns the version of an object; nothing if the object does not exist.
std::optional<RemoteVersion> look_at(const std::string& url);
/// Reads up to bytes.size() bytes from `offset` on, fewer at the end of the object. Returns their number. Throws if the
/// object is not the `expected` version; if `expected` is empty, sets `expected`.
std::size_t read_remote(const std::string& url, std::optional<RemoteVersion>& expected, std::uint64_t offset,
                        std::span<std::byte> bytes);
/// Returns the objects in a folder, whose URL ends in '/'. `recursive`: also objects in nested folders.
std::vector<RemoteEntry> list_remote(const std::string& folder, bool recursive);
/// Uploads a file as an object, which is visible only when it is complete. Throws if the object exists and `overwrite`
/// is false.
void upload(const std::string& url, const std::filesystem::path& file, bool overwrite);
/// Writes bytes as an object, in one request. Throws if the object exists and `overwrite` is false.
void put_remote(const std::string& url, std::span<const std::byte> bytes, bool overwrite);
/// Writes bytes as an object. Returns false, and writes nothing, if the object exists.
bool put_remote_if_absent(const std::string& url, std::span<const std::byte> bytes);
/// Removes an object if it exists.
void remove_remote(const std::string& url);

/// Throws unless this build can write URLs and `url` is in a bucket. Sends no request.
void require_writable_url(const std::string& url);

}  // namespace pointsweep
