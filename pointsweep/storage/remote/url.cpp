// SPDX-License-Identifier: MIT
#include "pointsweep/storage/remote/url.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <mutex>
#include <vector>

namespace pointsweep {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view kAuthority = "://";

/// Names of query parameters that give access to an object, in lower case. An entry may be only the beginning of a
/// name.
constexpr std::array kSecretParameters = {
    "x-amz-"sv, "x-goog-"sv,     "signature"sv, "sig"sv,    "awsaccesskeyid"sv, "googleaccessid"sv, "access_token"sv,
    "token"sv,  "key-pair-id"sv, "policy"sv,    "apikey"sv, "api_key"sv,        "password"sv};

/// The full addresses of URLs that were given with secrets, by the URLs without these secrets.
struct Addresses {
  std::mutex mutex;
  std::map<std::string, std::string, std::less<>> by_url;
};
Addresses& addresses() {
  static Addresses all;
  return all;
}

std::string in_lower(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

std::string_view scheme_of(std::string_view url) { return url.substr(0, url.find(kAuthority)); }

bool is_http(std::string_view url) { return scheme_of(url) == "http" || scheme_of(url) == "https"; }

bool has_secret(std::string_view query) {
  const std::string lower = in_lower(query);
  for (std::size_t begin = 0; begin <= lower.size();) {
    const std::string_view parameter = std::string_view(lower).substr(begin, lower.find('&', begin) - begin);
    if (std::ranges::any_of(kSecretParameters, [&](std::string_view name) { return parameter.starts_with(name); }))
      return true;
    begin += parameter.size() + 1;
  }
  return false;
}

/// Returns the URL without the user of its host and without a query that holds a secret. In the URL of a bucket, the
/// part before @ may be a container, which stays: abfs://container@account.
std::string shown_form(std::string_view url) {
  const std::size_t host = url.find(kAuthority) + kAuthority.size();
  const std::size_t path = std::min(url.find('/', host), url.size());
  const std::string_view authority = url.substr(host, path - host);
  const std::size_t at = authority.rfind('@');
  const bool has_user = at != authority.npos && (is_http(url) || authority.substr(0, at).find(':') != authority.npos);
  std::string shown(url.substr(0, host));
  shown += has_user ? authority.substr(at + 1) : authority;
  const std::string_view rest = url.substr(path);
  const std::size_t query = rest.find('?');
  shown += query != rest.npos && has_secret(rest.substr(query + 1)) ? rest.substr(0, query) : rest;
  return shown;
}

int digit_of(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  const char lower = static_cast<char>(c | 32);
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

/// Returns the path of a file URL: "/tmp/a.laz" for "file:///tmp/a.laz" and "file://localhost/tmp/a.laz".
std::string local_path(std::string_view url) {
  std::string_view rest = url.substr(url.find(kAuthority) + kAuthority.size());
  if (rest.starts_with("localhost/")) rest.remove_prefix(rest.find('/'));
  return percent_decoded(rest);
}

bool is_of_scheme(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '+' || c == '-' || c == '.'; }

}  // namespace

std::string percent_decoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_escape =
        text[i] == '%' && i + 2 < text.size() && digit_of(text[i + 1]) >= 0 && digit_of(text[i + 2]) >= 0;
    out += is_escape ? static_cast<char>(digit_of(text[i + 1]) * 16 + digit_of(text[i + 2])) : text[i];
    if (is_escape) i += 2;
  }
  return out;
}

bool is_url(std::string_view name) {
  const std::size_t end = name.find(kAuthority);
  return end != name.npos && end >= 2 && std::isalpha(static_cast<unsigned char>(name[0])) &&
         std::ranges::all_of(name.substr(0, end), is_of_scheme);
}
bool is_url(const std::string& name) { return is_url(std::string_view(name)); }
bool is_url(const std::filesystem::path& name) { return is_url(std::string_view(name.native())); }

bool is_bucket(std::string_view url) { return is_url(url) && !is_http(url); }

std::filesystem::path known_place(const std::filesystem::path& named) {
  const std::string& name = named.native();
  if (!is_url(std::string_view(name))) return named;
  if (scheme_of(name) == "file") return local_path(name);
  std::string shown = shown_form(name);
  if (shown == name) return named;
  const std::lock_guard lock(addresses().mutex);
  addresses().by_url.insert_or_assign(shown, name);
  return shown;
}

std::string with_known_places(const std::string& text) {
  if (is_url(std::string_view(text))) return known_place(text).native();
  std::string out;
  std::size_t done = 0;
  for (std::size_t at = text.find(kAuthority); at != text.npos; at = text.find(kAuthority, done)) {
    std::size_t begin = at;
    while (begin > done && is_of_scheme(text[begin - 1])) --begin;
    const std::size_t end = std::min(text.find_first_of(" \t\r\n\"'(),|", at), text.size());
    out += text.substr(done, begin - done) + known_place(text.substr(begin, end - begin)).native();
    done = end;
  }
  return out + text.substr(done);
}

std::string address_of(const std::string& url) {
  const std::lock_guard lock(addresses().mutex);
  const auto known = addresses().by_url.find(url);
  return known == addresses().by_url.end() ? url : known->second;
}

std::filesystem::path without_query(const std::filesystem::path& path) {
  const std::string& name = path.native();
  return is_url(path) && is_http(name) ? std::filesystem::path(name.substr(0, name.find_first_of("?#"))) : path;
}

std::string resolved(const std::string& base, const std::string& reference) {
  if (is_url(std::string_view(reference))) return reference;
  const std::string document = without_query(base).native();
  const std::size_t host = document.find(kAuthority) + kAuthority.size();
  const std::size_t root = std::min(document.find('/', host), document.size());
  std::string path = reference.starts_with('/') ? "" : document.substr(root, document.rfind('/') - root);
  std::vector<std::string> names;
  path += "/" + reference;
  for (std::size_t begin = 1; begin <= path.size();) {
    const std::string name = path.substr(begin, path.find('/', begin) - begin);
    begin += name.size() + 1;
    if (name == ".." && !names.empty()) names.pop_back();
    if (name != ".." && name != "." && !name.empty()) names.push_back(name);
  }
  std::string url = document.substr(0, root);
  for (const std::string& name : names) url += "/" + name;
  return url;
}

}  // namespace pointsweep
