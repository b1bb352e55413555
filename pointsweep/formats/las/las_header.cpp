// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_header.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "pointsweep/fail.h"
#include "pointsweep/formats/las/las_point_formats.h"

namespace pointsweep {
namespace {

static_assert(std::endian::native == std::endian::little, "LAS entries are copied in the machine's byte order");

constexpr std::uint16_t kSize10 = 227, kSize13 = 235, kSize14 = 375;
constexpr std::size_t kMinorAt = 25;
constexpr std::uint64_t kMaxLegacyCount = std::numeric_limits<std::uint32_t>::max();

/// Calls `at(byte offset, entry)` for every entry within the first `size` bytes of a header. Reading and writing share
/// this table of offsets.
template <class Header, class At>
void each_entry(Header& h, std::size_t size, At&& at) {
  at(6, h.global_encoding);
  at(kMinorAt, h.minor);
  at(94, h.header_size);
  at(96, h.offset_to_points);
  at(100, h.vlr_count);
  at(104, h.point_format);
  at(105, h.record_length);
  at(107, h.legacy_count);
  at(111, h.legacy_by_return);
  at(131, h.scale);
  at(155, h.offset);
  at(179, h.bounds.hi.x);
  at(187, h.bounds.lo.x);
  at(195, h.bounds.hi.y);
  at(203, h.bounds.lo.y);
  at(211, h.bounds.hi.z);
  at(219, h.bounds.lo.z);
  if (size >= kSize13) at(227, h.waveform_start);
  if (size < kSize14) return;
  at(235, h.evlr_start);
  at(243, h.evlr_count);
  at(247, h.count);
  at(255, h.by_return);
}

/// Bits of the point format by which LASzip marks a compressed file; its first versions set both bits.
constexpr std::uint8_t kCompressedBits = 0xC0;

void check_signature(std::span<const std::byte> bytes, std::string_view path) {
  if (bytes.empty()) fail("{}: is empty; a LAS file begins with 'LASF'.", path);
  if (bytes.size() < 4 || std::memcmp(bytes.data(), "LASF", 4) != 0) {
    fail("{}: is no LAS file, since it does not begin with 'LASF'.", path);
  }
  if (bytes.size() < kSize10) {
    fail("{}: ends at byte {}, inside the LAS header; the file is truncated, copy or export it again.", path,
         bytes.size());
  }
  const int major = static_cast<int>(bytes[24]), minor = static_cast<int>(bytes[kMinorAt]);
  if (major != 1 || minor > 4) {
    fail("{}: calls itself LAS {}.{} (byte 24); versions 1.0 to 1.4 can be read.", path, major, minor);
  }
}

void check_point_format(const LasHeader& h, std::string_view path) {
  const std::optional<std::uint16_t> least = las_record_length(h.point_format);
  if (!least) fail("{}: point format {} (byte 104) is not defined; LAS has 0 to 10.", path, h.point_format);
  if (h.record_length < *least) {
    fail("{}: a point record of {} bytes (byte 105) is too short for point format {}, which takes {}.", path,
         h.record_length, h.point_format, *least);
  }
}

void check_places(const LasHeader& h, std::uint64_t file_size, std::string_view path) {
  const std::uint16_t least = standard_header_size(h.minor);
  if (h.header_size < least) {
    fail(
        "{}: a header of {} bytes (byte 94) is too short for LAS 1.{}, which takes {}; repair it, e.g. with "
        "'lasinfo -repair'.",
        path, h.header_size, h.minor, least);
  }
  if (h.offset_to_points < h.header_size) {
    fail("{}: the points cannot begin at byte {} (byte 96), inside the header of {} bytes.", path, h.offset_to_points,
         h.header_size);
  }
  if (h.offset_to_points > file_size) {
    fail(
        "{}: the points should begin at byte {} (byte 96), but the file ends at byte {}; it is truncated, copy or "
        "export it again.",
        path, h.offset_to_points, file_size);
  }
}

void check_scale(const LasHeader& h, std::string_view path) {
  for (int axis = 0; axis < 3; ++axis) {
    const double scale = h.scale[axis];
    if (!(scale > 0) || !std::isfinite(scale)) {
      fail("{}: the scale of {} is {} (byte {}); it must be a positive number.", path, "xyz"[axis], scale,
           131 + 8 * axis);
    }
    if (!std::isfinite(h.offset[axis])) {
      fail("{}: the offset of {} is {} (byte {}); it must be a finite number.", path, "xyz"[axis], h.offset[axis],
           155 + 8 * axis);
    }
  }
}

void check_count(const LasHeader& h, std::uint64_t file_size, std::string_view path,
                 std::vector<std::string>& warnings) {
  const std::uint64_t promised = point_count(h);
  const std::uint64_t found = (file_size - h.offset_to_points) / h.record_length;
  if (!h.is_compressed && found < promised) {
    fail(
        "{}: is truncated; the header counts {} points, but the file ends after {} of them (byte {}); copy or "
        "export it again.",
        path, promised, found, file_size);
  }
  if (h.minor >= 4 && h.legacy_count != 0 && h.legacy_count != promised) {
    warnings.push_back(fmt::format("the header counts {} points with 64 bits and {} with 32: the former was taken.",
                                   promised, h.legacy_count));
  }
  if (h.minor >= 4 && h.count == 0 && h.legacy_count != 0) {
    warnings.push_back(fmt::format("the 64-bit count of points is 0: the legacy count {} was taken.", h.legacy_count));
  }
  if (!h.is_compressed && promised == 0 && found != 0) {
    warnings.push_back(
        fmt::format("the header counts no points, though {} bytes follow it.", file_size - h.offset_to_points));
  }
}

}  // namespace

std::uint16_t standard_header_size(int minor) { return minor >= 4 ? kSize14 : minor == 3 ? kSize13 : kSize10; }

std::uint64_t point_count(const LasHeader& header) {
  return header.minor >= 4 && header.count != 0 ? header.count : header.legacy_count;
}

LasHeader parse_las_header(std::span<const std::byte> bytes, std::uint64_t file_size, std::string_view path,
                           std::vector<std::string>& warnings) {
  check_signature(bytes, path);
  LasHeader header;
  const std::size_t standard = standard_header_size(static_cast<int>(bytes[kMinorAt]));
  if (bytes.size() < standard) {
    fail("{}: ends at byte {}, inside the LAS header; the file is truncated, copy or export it again.", path,
         bytes.size());
  }
  each_entry(header, standard,
             [&](std::size_t at, auto& entry) { std::memcpy(&entry, bytes.data() + at, sizeof entry); });
  header.is_compressed = (header.point_format & kCompressedBits) != 0;
  header.point_format &= static_cast<std::uint8_t>(~kCompressedBits);
  check_point_format(header, path);
  check_places(header, file_size, path);
  check_scale(header, path);
  check_count(header, file_size, path, warnings);
  return header;
}

LasHeader new_las_header() {
  LasHeader header;
  header.header_size = kSize14;
  header.global_encoding = kLasWktBit;
  header.bytes.resize(kSize14);
  const auto put = [&](std::size_t at, std::string_view text) {
    std::memcpy(header.bytes.data() + at, text.data(), text.size());
  };
  put(0, "LASF");
  header.bytes[24] = std::byte{1};
  put(26, "OTHER");
  put(58, "pointsweep");
  return header;
}

void upgrade_las_header(LasHeader& header, int minor) {
  if (header.minor >= minor) return;
  if (header.minor < 2) header.global_encoding = 0;  // LAS 1.0 and 1.1 reserve these bytes
  const std::uint16_t old = standard_header_size(header.minor), now = standard_header_size(minor);
  const auto behind = header.bytes.begin() + std::min<std::ptrdiff_t>(old, std::ssize(header.bytes));
  header.bytes.insert(behind, now - old, std::byte{0});
  header.header_size = static_cast<std::uint16_t>(header.header_size + now - old);
  header.minor = static_cast<std::uint8_t>(minor);
}

void set_las_version(LasHeader& header, int minor) {
  upgrade_las_header(header, minor);
  if (header.minor == minor) return;
  const std::uint16_t old = standard_header_size(header.minor), now = standard_header_size(minor);
  const auto size = std::ssize(header.bytes);
  header.bytes.erase(header.bytes.begin() + std::min<std::ptrdiff_t>(now, size),
                     header.bytes.begin() + std::min<std::ptrdiff_t>(old, size));
  header.header_size = static_cast<std::uint16_t>(header.header_size + now - old);
  header.minor = static_cast<std::uint8_t>(minor);
  header.global_encoding &= minor < 2 ? 0 : minor < 3 ? kLasStandardTimeBit : kLasEncodingBits13;
}

void set_counts(LasHeader& header, std::uint64_t count, const std::array<std::uint64_t, 16>& by_return) {
  const bool legacy = header.minor < 4 || (header.point_format <= 5 && count <= kMaxLegacyCount);
  header.legacy_count = legacy ? static_cast<std::uint32_t>(count) : 0;
  for (std::size_t r = 0; r < 5; ++r) {
    header.legacy_by_return[r] = legacy ? static_cast<std::uint32_t>(by_return[r + 1]) : 0;
  }
  header.count = count;
  for (std::size_t r = 0; r < 15; ++r) header.by_return[r] = by_return[r + 1];
}

std::vector<std::byte> serialize(const LasHeader& header) {
  std::vector<std::byte> bytes = header.bytes;
  bytes.resize(header.header_size);
  each_entry(header, standard_header_size(header.minor),
             [&](std::size_t at, const auto& entry) { std::memcpy(bytes.data() + at, &entry, sizeof entry); });
  return bytes;
}

}  // namespace pointsweep
