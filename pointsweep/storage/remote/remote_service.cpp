// SPDX-License-Identifier: MIT
#include "pointsweep/storage/remote/remote_service.h"

#include <fmt/format.h>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/storage/remote/url.h"

#if POINTSWEEP_REMOTE
#include <pointsweep_remote.h>
#endif

namespace pointsweep {
namespace {

#if POINTSWEEP_REMOTE

int is_cancelled() {
  const CancellationToken* const token = CancellationScope::current();
  return token != nullptr && token->cancelled() ? 1 : 0;
}

/// Returns a clause for messages that tells how to give the credentials for a URL.
const char* credentials_for(const std::string& url) {
  if (url.starts_with("s3"))
    return "set AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY and AWS_REGION, or AWS_SKIP_SIGNATURE=true for a public "
           "bucket";
  if (url.starts_with("gs"))
    return "set GOOGLE_SERVICE_ACCOUNT to the file of its key, or GOOGLE_SKIP_SIGNATURE=true for a public bucket";
  if (url.starts_with("http")) return "check the user, the password or the signature of the address";
  return "set AZURE_STORAGE_ACCOUNT_NAME and AZURE_STORAGE_ACCOUNT_KEY or AZURE_STORAGE_SAS_TOKEN";
}

[[noreturn]] void fail_with(int status, const std::string& url, const psr_detail& words) {
  const std::string detail = words.text;
  switch (status) {
    case PSR_CANCELLED:
      throw Cancelled();
    case PSR_NOT_FOUND:
      fail("{}: no such object ({}); check the address{}.", url, detail,
           is_bucket(url) ? "; that of a folder ends in '/'" : "");
    case PSR_DENIED:
      fail("{}: access is denied ({}); {}.", url, detail, credentials_for(url));
    case PSR_EXISTS:
      fail("{}: exists already; choose another name, or allow it to be replaced (--force).", url);
    case PSR_CHANGED:
      fail("{}: has changed since it was opened ({}); run again when nothing writes there.", url, detail);
    case PSR_NO_RANGES:
      fail("{}: its server gives whole files only ({}), and parts are read; download the file and name the copy.", url,
           detail);
    case PSR_UNAVAILABLE:
      fail("{}: its server does not answer ({}, after several attempts); try again later, or check the network.", url,
           detail);
    case PSR_TRUNCATED:
      fail("{}: {}, several times; try again later, or check the network.", url, detail);
    case PSR_TLS:
      fail(
          "{}: there is no secure connection to its server ({}); check the address, or name the certificates to trust "
          "with "
          "SSL_CERT_FILE.",
          url, detail);
    case PSR_NOT_POSSIBLE:
      fail("{}: {}; name a place in a bucket (s3://, gs://, az://), or files one by one.", url, detail);
    case PSR_WRONG_ADDRESS:
      fail(
          "{}: is no address that can be used: {}; write https://HOST/FILE, s3://BUCKET/KEY, gs://BUCKET/KEY or "
          "az://CONTAINER/KEY.",
          url, detail);
    case PSR_FILE:
      fail("{}: what is to be uploaded cannot be read: {}; check the temporary folder.", url, detail);
    default:
      fail("{}: the request failed: {}; check the address and what the server expects.", url, detail);
  }
}

RemoteVersion version_of(const psr_version& found) {
  return {found.size, found.seconds, found.nanoseconds, found.etag};
}

psr_version version_for(const RemoteVersion& version) {
  psr_version out{version.size, version.seconds, version.nanoseconds, {}};
  version.etag.copy(out.etag, sizeof out.etag - 1);
  return out;
}

/// Throws UsageError for an address in a bucket with a password or signature: only http addresses may contain these.
void require_no_secret(const std::string& url) {
  if (is_bucket(url) && address_of(url) != url)
    fail_usage("{}: credentials in the address of a bucket are not used; {}.", url, credentials_for(url));
}

/// Sends a request for `url` by send(address, detail), which returns a status. Returns the status if it is PSR_DONE or
/// `other`; throws Error for all other statuses.
template <class Send>
int request(const std::string& url, Send send, int other = PSR_DONE) {
  require_no_secret(url);
  stop_if_cancelled();
  static const bool is_set = (psr_set_cancelled(&is_cancelled), true);
  static_cast<void>(is_set);
  psr_detail detail{};
  const int status = send(address_of(url).c_str(), &detail);
  if (status != PSR_DONE && status != other) fail_with(status, url, detail);
  return status;
}

/// Writes bytes as an object. Returns PSR_DONE or `other`.
int put(const std::string& url, std::span<const std::byte> bytes, bool overwrite, int other) {
  const auto* const first = reinterpret_cast<const std::uint8_t*>(bytes.data());
  return request(
      url,
      [&](const char* address, psr_detail* detail) { return psr_put(address, first, bytes.size(), overwrite, detail); },
      other);
}

#else

[[noreturn]] void fail_without(const std::string& url) {
  fail(
      "{}: is a URL, which this build of pointsweep cannot read or write; build it with -D POINTSWEEP_REMOTE=ON, or "
      "copy the file.",
      url);
}

#endif

}  // namespace

bool RemoteVersion::is(const RemoteVersion& other) const {
  if (size != other.size) return false;
  if (!etag.empty() && !other.etag.empty()) return etag == other.etag;
  return seconds == other.seconds && nanoseconds == other.nanoseconds;
}

std::string RemoteVersion::text() const {
  if (!etag.empty()) return fmt::format("{} bytes, ETag {}", size, etag);
  return fmt::format("{} bytes, written at {}.{:09}", size, seconds, nanoseconds);
}

#if POINTSWEEP_REMOTE

bool reads_urls() { return true; }

std::optional<RemoteVersion> look_at(const std::string& url) {
  psr_version found{};
  const auto look = [&](const char* address, psr_detail* detail) { return psr_look(address, &found, detail); };
  return request(url, look, PSR_NOT_FOUND) == PSR_DONE ? std::optional(version_of(found)) : std::nullopt;
}

std::size_t read_remote(const std::string& url, std::optional<RemoteVersion>& expected, std::uint64_t offset,
                        std::span<std::byte> bytes) {
  const psr_version wanted = expected ? version_for(*expected) : psr_version{};
  psr_version found{};
  std::size_t read = 0;
  request(url, [&](const char* address, psr_detail* detail) {
    return psr_read(address, expected ? &wanted : nullptr, offset, reinterpret_cast<std::uint8_t*>(bytes.data()),
                    bytes.size(), &read, &found, detail);
  });
  if (!expected) expected = version_of(found);
  return read;
}

std::vector<RemoteEntry> list_remote(const std::string& folder, bool recursive) {
  struct Listing {
    const std::string& folder;
    std::vector<RemoteEntry> entries;
  } listing{folder, {}};
  const auto visit = [](void* context, const char* key, std::uint64_t size) {
    auto& to = *static_cast<Listing*>(context);
    to.entries.push_back({to.folder + key, size});
  };
  request(folder, [&](const char* address, psr_detail* detail) {
    return psr_list(address, recursive, visit, &listing, detail);
  });
  return std::move(listing.entries);
}

void upload(const std::string& url, const std::filesystem::path& file, bool overwrite) {
  request(url, [&](const char* address, psr_detail* detail) {
    return psr_put_file(address, file.c_str(), overwrite, detail);
  });
}

void put_remote(const std::string& url, std::span<const std::byte> bytes, bool overwrite) {
  put(url, bytes, overwrite, PSR_DONE);
}

bool put_remote_if_absent(const std::string& url, std::span<const std::byte> bytes) {
  return put(url, bytes, false, PSR_EXISTS) == PSR_DONE;
}

void remove_remote(const std::string& url) {
  request(url, [](const char* address, psr_detail* detail) { return psr_remove(address, detail); });
}

#else

bool reads_urls() { return false; }
std::optional<RemoteVersion> look_at(const std::string& url) { fail_without(url); }
std::size_t read_remote(const std::string& url, std::optional<RemoteVersion>&, std::uint64_t, std::span<std::byte>) {
  fail_without(url);
}
std::vector<RemoteEntry> list_remote(const std::string& folder, bool) { fail_without(folder); }
void upload(const std::string& url, const std::filesystem::path&, bool) { fail_without(url); }
void put_remote(const std::string& url, std::span<const std::byte>, bool) { fail_without(url); }
bool put_remote_if_absent(const std::string& url, std::span<const std::byte>) { fail_without(url); }
void remove_remote(const std::string& url) { fail_without(url); }

#endif

void require_writable_url(const std::string& url) {
  if (!reads_urls()) static_cast<void>(look_at(url));  // throws, since this build has no client library
  if (!is_bucket(url))
    fail("{}: a server of HTTP is read alone; write to a bucket (s3://, gs://, az://) or to a file.", url);
}

}  // namespace pointsweep
