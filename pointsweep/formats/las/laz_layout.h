// SPDX-License-Identifier: MIT
/// The C++ side of the LASzip codec (codecs/), with errors as exceptions: the content of the LASzip VLR, the chunk
/// table and the compression of chunks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

struct psc_laz;

namespace pointsweep {

/// User and record number of the LASzip VLR.
inline constexpr std::string_view kLaszipUser = "laszip encoded";
inline constexpr std::uint16_t kLaszipRecord = 22204;

/// Points in each chunk of written files other than COPC; most writers use this number.
inline constexpr std::uint32_t kLazChunkPoints = 50'000;

/// Bytes before the first chunk, which store the offset of the chunk table.
inline constexpr std::uint64_t kLazOffsetBytes = 8;

/// The compression of records. Immutable, so that any number of threads may use it.
class LazLayout {
 public:
  /// Decodes the content of the LASzip VLR. Throws Error, which begins with `path`.
  static LazLayout parse(std::span<const std::byte> vlr, const std::string& path);
  /// Makes a layout for writing records of a point format (0 to 10) with extra bytes; `chunk_points` may be kVariable.
  /// Throws Error for other formats.
  static LazLayout for_format(std::uint8_t point_format, std::uint16_t extra_bytes, std::uint32_t chunk_points,
                              const std::string& path);

  static constexpr std::uint32_t kVariable = 0, kNoChunks = ~std::uint32_t{0};
  /// Returns the number of points in every chunk but the last; kVariable if the chunk table states it for each chunk;
  /// kNoChunks if all points are in one run without a table.
  std::uint32_t chunk_points() const;
  std::uint32_t record_bytes() const;
  std::vector<std::byte> vlr() const;

  struct ChunkSize {
    std::uint64_t points, bytes;  ///< points: 0 unless chunks vary in size
  };
  /// Decodes the chunk table with which `table` begins. Throws Error unless it has `count` chunks.
  std::vector<ChunkSize> read_chunk_table(std::span<const std::byte> table, std::size_t count) const;
  std::vector<std::byte> write_chunk_table(std::span<const ChunkSize> chunks) const;

  /// Compresses one chunk of whole records, at least one. Thread-safe.
  std::vector<std::byte> compress(std::span<const std::byte> records) const;

  const psc_laz* codec() const { return codec_.get(); }
  /// Throws Error that says that the file cannot be decompressed, and why.
  [[noreturn]] void fail_with(const char* reason) const;

 private:
  LazLayout(std::shared_ptr<const psc_laz> codec, std::string path)
      : codec_(std::move(codec)), path_(std::move(path)) {}

  std::shared_ptr<const psc_laz> codec_;
  std::string path_;
};

/// Returns whether this library was built with codecs. Without codecs, parse() and for_format() of LazLayout throw
/// Error.
bool has_laz();

}  // namespace pointsweep
