// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/laz_layout.h"

#include "pointsweep/fail.h"

#if POINTSWEEP_CODECS
#include <pointsweep_codecs.h>
#endif

namespace pointsweep {

#if POINTSWEEP_CODECS

namespace {

std::shared_ptr<const psc_laz> owned(psc_laz* codec) { return {codec, psc_laz_free}; }

const std::uint8_t* plain(std::span<const std::byte> bytes) {
  return reinterpret_cast<const std::uint8_t*>(bytes.data());
}

/// Copies bytes that the codec has allocated, and frees them.
std::vector<std::byte> taken(std::uint8_t* bytes, std::size_t size) {
  const auto* first = reinterpret_cast<const std::byte*>(bytes);
  std::vector<std::byte> copy(first, first + size);
  psc_free_bytes(bytes, size);
  return copy;
}

}  // namespace

bool has_laz() { return true; }

void LazLayout::fail_with(const char* reason) const {
  fail("{}: cannot be decompressed: {}; copy or export it again.", path_, reason);
}

LazLayout LazLayout::parse(std::span<const std::byte> vlr, const std::string& path) {
  psc_laz* codec = nullptr;
  psc_error error;
  if (psc_laz_parse(plain(vlr), vlr.size(), &codec, &error) != 0)
    fail("{}: cannot be decompressed: {} (LASzip VLR); copy or export it again.", path, error.text);
  return {owned(codec), path};
}

LazLayout LazLayout::for_format(std::uint8_t point_format, std::uint16_t extra_bytes, std::uint32_t chunk_points,
                                const std::string& path) {
  psc_laz* codec = nullptr;
  psc_error error;
  if (psc_laz_for_format(point_format, extra_bytes, chunk_points, &codec, &error) != 0)
    fail("{}: cannot be compressed: {}.", path, error.text);
  return {owned(codec), path};
}

std::uint32_t LazLayout::chunk_points() const { return psc_laz_chunk_points(codec()); }
std::uint32_t LazLayout::record_bytes() const { return psc_laz_record_bytes(codec()); }

std::vector<std::byte> LazLayout::vlr() const {
  std::vector<std::byte> bytes(psc_laz_vlr(codec(), nullptr, 0));
  psc_laz_vlr(codec(), reinterpret_cast<std::uint8_t*>(bytes.data()), bytes.size());
  return bytes;
}

std::vector<LazLayout::ChunkSize> LazLayout::read_chunk_table(std::span<const std::byte> table,
                                                              std::size_t count) const {
  std::vector<std::uint64_t> points(count), sizes(count);
  psc_error error;
  if (psc_laz_read_chunk_table(codec(), plain(table), table.size(), count, points.data(), sizes.data(), &error) != 0)
    fail_with(error.text);
  std::vector<ChunkSize> chunks(count);
  for (std::size_t i = 0; i < count; ++i) chunks[i] = {points[i], sizes[i]};
  return chunks;
}

std::vector<std::byte> LazLayout::write_chunk_table(std::span<const ChunkSize> chunks) const {
  std::vector<std::uint64_t> points, sizes;
  for (const ChunkSize& chunk : chunks) {
    points.push_back(chunk.points);
    sizes.push_back(chunk.bytes);
  }
  std::uint8_t* bytes = nullptr;
  std::size_t size = 0;
  psc_error error;
  if (psc_laz_write_chunk_table(codec(), points.data(), sizes.data(), chunks.size(), &bytes, &size, &error) != 0)
    fail("{}: cannot be compressed: {}.", path_, error.text);
  return taken(bytes, size);
}

std::vector<std::byte> LazLayout::compress(std::span<const std::byte> records) const {
  std::uint8_t* bytes = nullptr;
  std::size_t size = 0;
  psc_error error;
  if (psc_laz_encode(codec(), plain(records), records.size(), &bytes, &size, &error) != 0)
    fail("{}: cannot be compressed: {}.", path_, error.text);
  return taken(bytes, size);
}

#else

namespace {

[[noreturn]] void fail_without_codecs(const std::string& path) {
  fail(
      "{}: is compressed (LAZ), and this pointsweep was built without its codecs (POINTSWEEP_CODECS); decompress it "
      "first, e.g. with 'laszip -i FILE', or install cargo and build again.",
      path);
}

}  // namespace

bool has_laz() { return false; }
LazLayout LazLayout::parse(std::span<const std::byte>, const std::string& path) { fail_without_codecs(path); }
LazLayout LazLayout::for_format(std::uint8_t, std::uint16_t, std::uint32_t, const std::string& path) {
  fail("{}: this pointsweep was built without codecs (POINTSWEEP_CODECS) and cannot write LAZ; write .las.", path);
}
void LazLayout::fail_with(const char*) const { fail_without_codecs(path_); }
std::uint32_t LazLayout::chunk_points() const { fail_without_codecs(path_); }
std::uint32_t LazLayout::record_bytes() const { fail_without_codecs(path_); }
std::vector<std::byte> LazLayout::vlr() const { fail_without_codecs(path_); }
std::vector<LazLayout::ChunkSize> LazLayout::read_chunk_table(std::span<const std::byte>, std::size_t) const {
  fail_without_codecs(path_);
}
std::vector<std::byte> LazLayout::write_chunk_table(std::span<const ChunkSize>) const { fail_without_codecs(path_); }
std::vector<std::byte> LazLayout::compress(std::span<const std::byte>) const { fail_without_codecs(path_); }

#endif

}  // namespace pointsweep
