// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>

#include "pointsweep/fail.h"
#include "pointsweep/formats/npy/npy_format.h"

namespace pointsweep {
namespace {

constexpr std::string_view kLocalHeader("PK\3\4", 4), kDirectoryEntry("PK\1\2", 4), kDirectoryEnd("PK\5\6", 4),
    kDirectoryEnd64("PK\6\6", 4), kLocator64("PK\6\7", 4);
constexpr std::uint64_t kLocalBytes = 30, kEntryBytes = 46, kEndBytes = 22, kEnd64Bytes = 56, kLocatorBytes = 20;
constexpr std::uint64_t kLongestComment = 65535, kMostMembers = 4096;
constexpr std::uint32_t kIn64 = 0xffffffff;  ///< means that the value is in a zip64 record
constexpr std::string_view kArrayName = ".npy";

/// Returns a little-endian number of `size` bytes.
std::uint64_t number_at(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = size; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

class NpzDirectory {
 public:
  explicit NpzDirectory(const InputFile& file) : file_(file) {}

  std::vector<NpzMember> members() {
    find_directory();
    std::vector<NpzMember> members;
    for (std::uint64_t i = 0; i < entries_; ++i) take_entry(members);
    return members;
  }

 private:
  [[noreturn]] void fail_damaged() const {
    fail("{}: is a damaged or incomplete NPZ archive; get the whole file.", file_.path().string());
  }

  std::string bytes_at(std::uint64_t offset, std::uint64_t size) const {
    if (offset > file_.size() || size > file_.size() - offset) fail_damaged();
    std::string bytes(static_cast<std::size_t>(size), '\0');
    file_.read_at(offset, std::as_writable_bytes(std::span(bytes)));
    return bytes;
  }

  /// Finds the directory by the record at the end of the file.
  void find_directory() {
    const std::uint64_t window = std::min(file_.size(), kEndBytes + kLongestComment);
    const std::string tail = bytes_at(file_.size() - window, window);
    const std::size_t at = tail.rfind(kDirectoryEnd);
    if (at == tail.npos || tail.size() - at < kEndBytes) fail_damaged();
    entries_ = number_at(tail, at + 10, 2);
    next_ = number_at(tail, at + 16, 4);
    const std::uint64_t end = file_.size() - window + at;
    if (end >= kLocatorBytes) {
      const std::string locator = bytes_at(end - kLocatorBytes, kLocatorBytes);
      if (locator.starts_with(kLocator64)) {
        const std::string end64 = bytes_at(number_at(locator, 8, 8), kEnd64Bytes);
        if (!end64.starts_with(kDirectoryEnd64)) fail_damaged();
        entries_ = number_at(end64, 32, 8);
        next_ = number_at(end64, 48, 8);
      }
    }
    if (entries_ > kMostMembers) fail("{}: has more than {} members.", file_.path().string(), kMostMembers);
  }

  void take_entry(std::vector<NpzMember>& members) {
    const std::string entry = bytes_at(next_, kEntryBytes);
    if (!entry.starts_with(kDirectoryEntry)) fail_damaged();
    const std::uint64_t name_bytes = number_at(entry, 28, 2), extra_bytes = number_at(entry, 30, 2);
    NpzMember member{.name = bytes_at(next_ + kEntryBytes, name_bytes)};
    const std::string extra = bytes_at(next_ + kEntryBytes + name_bytes, extra_bytes);
    next_ += kEntryBytes + name_bytes + extra_bytes + number_at(entry, 32, 2);
    if (!member.name.ends_with(kArrayName)) return;
    if (number_at(entry, 10, 2) != 0)
      fail("{}: is compressed, and pointsweep reads stored archives; save it with numpy.savez, not savez_compressed.",
           file_.path().string());
    // Numbers that do not fit in 32 bits follow in the extra bytes, in this order.
    std::array<std::uint64_t, 3> values{number_at(entry, 24, 4), number_at(entry, 20, 4), number_at(entry, 42, 4)};
    take_large(extra, values);
    const std::string local = bytes_at(values[2], kLocalBytes);
    if (!local.starts_with(kLocalHeader)) fail_damaged();
    member.begin = values[2] + kLocalBytes + number_at(local, 26, 2) + number_at(local, 28, 2);
    if (member.begin > file_.size() || values[0] > file_.size() - member.begin) fail_damaged();
    member.end = member.begin + values[0];
    member.name.resize(member.name.size() - kArrayName.size());
    members.push_back(std::move(member));
  }

  /// Replaces the values that are in the zip64 field (tag 1) of the extra bytes: size, compressed size, offset.
  static void take_large(std::string_view extra, std::array<std::uint64_t, 3>& values) {
    while (extra.size() >= 4) {
      const std::size_t size = std::min<std::size_t>(number_at(extra, 2, 2), extra.size() - 4);
      std::string_view field = extra.substr(4, size);
      if (number_at(extra, 0, 2) == 1) {
        for (std::uint64_t& value : values) {
          if (value != kIn64 || field.size() < 8) continue;
          value = number_at(field, 0, 8);
          field.remove_prefix(8);
        }
      }
      extra.remove_prefix(4 + size);
    }
  }

  const InputFile& file_;
  std::uint64_t entries_ = 0, next_ = 0;  ///< entries of the directory; byte of its next entry
};

}  // namespace

bool starts_as_npz(std::string_view head) {
  if (!head.starts_with(kLocalHeader) || head.size() < kLocalBytes) return false;
  return head.substr(kLocalBytes, static_cast<std::size_t>(number_at(head, 26, 2))).ends_with(kArrayName);
}

std::vector<NpzMember> npz_members(const InputFile& file) { return NpzDirectory(file).members(); }

}  // namespace pointsweep
