// SPDX-License-Identifier: MIT
/// The LASzip codec (codecs/) as C++ sees it: what the LASzip VLR says, with errors as exceptions.
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

/// User and record of the VLR.
inline constexpr std::string_view kLaszipUser = "laszip encoded";
inline constexpr std::uint16_t kLaszipRecord = 22204;

/// Points in each chunk of the files that are written, as most writers have it.
inline constexpr std::uint32_t kLazChunkPoints = 50'000;

/// In front of the first chunk: the byte where the chunk table begins, as 64 bits.
inline constexpr std::uint64_t kLazOffsetBytes = 8;

/// The way in which records are compressed. Immutable, so that any number of threads may use it.
class LazLayout {
 public:
  /// Reads the content of the VLR. Throws Error: "PATH: cannot be decompressed: ...".
  static LazLayout parse(std::span<const std::byte> vlr, const std::string& path);
  /// For writing records of a point format (0 to 10) with extra bytes; `chunk_points` may be kVariable. Throws Error.
  static LazLayout for_format(std::uint8_t point_format, std::uint16_t extra_bytes, std::uint32_t chunk_points,
                              const std::string& path);

  static constexpr std::uint32_t kVariable = 0, kNoChunks = ~std::uint32_t{0};
  /// Points in every chunk but the last; kVariable if the chunk table says how many; kNoChunks if all points are in one
  /// run without a table.
  std::uint32_t chunk_points() const;
  std::uint32_t record_bytes() const;
  std::vector<std::byte> vlr() const;

  struct ChunkSize {
    std::uint64_t points, bytes;  ///< points: 0 unless chunks vary
  };
  /// `table` begins with the chunk table, which must be one of `count` chunks.
  std::vector<ChunkSize> read_chunk_table(std::span<const std::byte> table, std::size_t count) const;
  std::vector<std::byte> write_chunk_table(std::span<const ChunkSize> chunks) const;

  /// One chunk of whole records, at least one. Thread-safe.
  std::vector<std::byte> compress(std::span<const std::byte> records) const;

  const psc_laz* codec() const { return codec_.get(); }
  [[noreturn]] void fail_with(const char* reason) const;

 private:
  LazLayout(std::shared_ptr<const psc_laz> codec, std::string path)
      : codec_(std::move(codec)), path_(std::move(path)) {}

  std::shared_ptr<const psc_laz> codec_;
  std::string path_;
};

/// Returns whether this library was built with codecs. Without codecs, LazLayout's makers throw Error.
bool has_laz();

}  // namespace pointsweep
