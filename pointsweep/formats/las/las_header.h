// SPDX-License-Identifier: MIT
/// The public header block of LAS 1.0 to 1.4. The parser checks version, point format, sizes, counts and scales.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/math/box.h"

namespace pointsweep {

/// Bits of the global encoding. WKT bit: the coordinate reference system is stated as WKT; point formats 6 to 10 must
/// set the bit even without a system. Time bit: GPS times are adjusted standard GPS time, not seconds of the GPS week.
inline constexpr std::uint16_t kLasWktBit = 1 << 4, kLasStandardTimeBit = 1 << 0;
/// Bits of the global encoding that say that waveforms are in this file, or in another file.
inline constexpr std::uint16_t kLasWaveformBits = 1 << 1 | 1 << 2;
/// Bits of the global encoding that LAS 1.3 defines.
inline constexpr std::uint16_t kLasEncodingBits13 = 0x0F;

/// The header entries that the library uses. All other entries (GUID, system identifier, dates, ...) stay in `bytes`.
struct LasHeader {
  std::uint8_t minor = 4;  ///< LAS 1.`minor`
  std::uint16_t global_encoding = 0;
  std::uint16_t header_size = 0;
  std::uint32_t offset_to_points = 0;
  std::uint32_t vlr_count = 0;
  std::uint8_t point_format = 0;  ///< without the bits that mark a compressed file
  bool is_compressed = false;     ///< compressed by LASzip; serialize() never writes this
  std::uint16_t record_length = 0;
  std::uint32_t legacy_count = 0;
  std::array<std::uint32_t, 5> legacy_by_return{};
  Vec3 scale{1, 1, 1};
  Vec3 offset;
  Box bounds{};  ///< bounds of the real coordinates
  std::uint64_t waveform_start = 0;
  std::uint64_t evlr_start = 0;
  std::uint32_t evlr_count = 0;
  std::uint64_t count = 0;  ///< number of points, from LAS 1.4 on; see point_count()
  std::array<std::uint64_t, 15> by_return{};

  std::vector<std::byte> bytes;  ///< the block as read, including user bytes after the standard bytes
};

/// Returns the bytes of the header of LAS 1.`minor`: 227, 235 from 1.3 on, 375 from 1.4 on.
std::uint16_t standard_header_size(int minor);

/// Parses `bytes`, the first bytes of a file of `file_size` bytes (standard_header_size(4) bytes, or the whole file if
/// it is shorter). Throws Error naming `path` if an entry contradicts itself or the file's size, or has a value that
/// the library does not support. `header.bytes` stays empty, since the header may be longer than `bytes`. Counts that
/// contradict each other are no error but add to `warnings`. The presence of the points of a compressed file is not
/// checked.
LasHeader parse_las_header(std::span<const std::byte> bytes, std::uint64_t file_size, std::string_view path,
                           std::vector<std::string>& warnings);

/// Returns the number of points that the header states: the 64-bit count of LAS 1.4 unless it is 0, else the legacy
/// count.
std::uint64_t point_count(const LasHeader& header);

/// Returns a header of LAS 1.4 without points, VLRs and dates. Dates would make the bytes of equal runs differ.
LasHeader new_las_header();

/// Turns an older header into a header of LAS 1.`minor`, in LAS 1.4 with room for 64-bit counts. A newer header stays
/// unchanged. User bytes after the header stay after it. The global encoding of a header before LAS 1.2, which reserves
/// these bits, becomes 0.
void upgrade_las_header(LasHeader& header, int minor);

/// Turns a header of any version into a header of LAS 1.`minor`. Clears the bits of the global encoding that an older
/// version reserves. If LAS 1.`minor` is older than the header, the file must have no extended VLRs and no waveforms.
void set_las_version(LasHeader& header, int minor);

/// Sets the counts of the header by the rules of its version: legacy counts are 0 if LAS 1.4 demands 0. `by_return[r]`
/// is the number of points with return number r (entry 0 is not used).
void set_counts(LasHeader& header, std::uint64_t count, const std::array<std::uint64_t, 16>& by_return);

/// Returns `header.header_size` bytes: `header.bytes` with the entries of `header` written into it.
std::vector<std::byte> serialize(const LasHeader& header);

}  // namespace pointsweep
