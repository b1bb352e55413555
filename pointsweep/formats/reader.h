// SPDX-License-Identifier: MIT
/// Reading point files: one interface for all formats, which formats/registry.h tells apart by content.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/formats/crs.h"
#include "pointsweep/formats/las_origin.h"
#include "pointsweep/math/box.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// What a format keeps of a file in addition to its points, for a writer of the same format (LAS: header, VLRs, EVLRs;
/// PLY: comments and obj_info). A writer of another format ignores it.
struct FormatExtras {
  virtual ~FormatExtras() = default;
};

struct FileInfo {
  std::filesystem::path path;
  std::string format;  ///< for people: "PLY 1.0 binary_little_endian", "LAS 1.4 point format 7"
  Schema schema;
  std::uint64_t count = 0;            ///< points really in the file, never merely what a header claims
  std::uint64_t left_out = 0;         ///< points of the file that `count` and read() leave out (FiniteRows)
  std::uint64_t bytes = 0;            ///< size of the file
  std::uint64_t decoder_bytes = 0;    ///< what each thread takes that decodes it, in addition to the records
  std::optional<Box> bounds;          ///< as a header states them: a hint, not to be trusted
  bool z_is_up = false;               ///< the format says that z is the height
  std::vector<std::string> warnings;  ///< what was wrong but harmless, one sentence each
  std::shared_ptr<const FormatExtras> extras;
  std::optional<Crs> crs;               ///< the coordinate reference system, if the file states one
  std::optional<LasOrigin> las;         ///< if the file is LAS, or its points once were
  std::vector<std::string> provenance;  ///< lines that say how the file was made (formats/provenance.h); may be empty
};

class Reader {
 public:
  virtual ~Reader() = default;
  const FileInfo& info() const { return info_; }

  /// Reads the records `row`, `row+1`, ... into `records` (as many whole records as fit, fewer only at the end of the
  /// cloud) and returns how many. Consecutive calls run at disk speed; a jump is cheap for binary formats and costs at
  /// most a rescan of 65,536 lines for text. Not thread-safe. Throws Error when the file fails or has changed.
  virtual std::size_t read(std::uint64_t row, std::span<std::byte> records) = 0;
  /// Frees what it keeps from one read() to the next, since others are read now.
  virtual void rest() {}

 protected:
  /// How many records a read() at `row` into `records` gives.
  std::size_t rows_for(std::uint64_t row, std::span<std::byte> records) const {
    const std::uint64_t left = row < info_.count ? info_.count - row : 0;
    return static_cast<std::size_t>(std::min<std::uint64_t>(left, records.size() / info_.schema.stride));
  }

  FileInfo info_;
};

/// Opens a point file of any known format. Throws Error in one sentence when it cannot.
std::unique_ptr<Reader> open_reader(const std::filesystem::path& path);

}  // namespace pointsweep
