// SPDX-License-Identifier: MIT
/// Classes that the writers of LAS, LAZ and COPC share: the file except its points, the count and bounds of the points,
/// the encoding of records, and the base of the writers.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/formats/las/las_header.h"
#include "pointsweep/formats/las/las_layout.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/storage/local/output_file.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// The statistics of all points in a LAS header: bounds and the number of points by return.
class LasStatistics {
 public:
  explicit LasStatistics(int point_format);

  /// Takes `count` LAS records, `stride` bytes apart.
  void add(const std::byte* records, std::size_t stride, std::size_t count);
  /// Adds the points that `other` has counted.
  void add(const LasStatistics& other);
  /// Returns the number of points taken so far.
  std::uint64_t count() const { return count_; }
  /// Sets counts and bounds; without points the bounds are 0.
  void put_into(LasHeader& header) const;

 private:
  static constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
  static constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();

  std::array<std::int32_t, 3> lo_{kMost, kMost, kMost}, hi_{kLeast, kLeast, kLeast};
  std::array<std::uint64_t, 16> by_return_{};
  std::uint64_t count_ = 0;
  std::uint8_t return_mask_;
};

/// The output file of a writer, and all of its bytes other than the points.
class LasFrame {
 public:
  /// Writes all bytes before the points. Throws Error, before anything is written, if the points cannot be stored.
  LasFrame(const OutputPlan& plan, LasPoints points);

  const LasLayout& layout() const { return layout_; }
  OutputFile& file() { return out_; }
  /// Writes bytes at offset `at`. Thread-safe for ranges that do not overlap.
  void put(std::uint64_t at, std::span<const std::byte> bytes);
  std::uint64_t bytes_written() const { return bytes_written_; }

  /// Returns the number of points in the plan.
  std::uint64_t planned() const { return planned_; }
  [[noreturn]] void fail_since_more_came() const;
  /// Throws Error unless `came` equals the number of points in the plan.
  void require_count(std::uint64_t came) const;
  /// Returns the number of bytes that are copied from the input to the place after the points.
  std::uint64_t tail_bytes() const;
  /// Finishes a file whose points, with the chunk table of compressed points, end before byte `points_end`: writes the
  /// pieces of the input that follow the points, then `last`, then the final header. Gives the file its name.
  void finish(const LasStatistics& points, std::uint64_t points_end, std::span<const std::byte> last = {});

 private:
  std::uint64_t copy(const LasPiece& piece, std::uint64_t to);
  std::uint64_t copy(const std::vector<LasPiece>& pieces, std::uint64_t to);
  void put_header();

  std::string path_;
  std::uint64_t planned_;
  LasLayout layout_;
  OutputFile out_;
  std::vector<std::byte> scratch_;
  std::atomic<std::uint64_t> bytes_written_ = 0;
};

/// Converts incoming records to records of a LAS file.
class LasEncoder {
 public:
  /// `path` is used in messages only.
  LasEncoder(const LasLayout& layout, std::string path);

  /// Returns whether the incoming records have the bytes of the records in the file.
  bool is_identity() const {
    return conversion_.is_identity() && !positions_change_ && missing_returns_ == std::byte{0} && !overlap_by_class_;
  }
  std::size_t record_bytes_in() const { return stride_in_; }
  std::size_t record_bytes_out() const { return stride_out_; }

  /// Encodes `count` records; `row` is the number of the first. Thread-safe. Throws Error for coordinates that LAS
  /// cannot hold: NaN, infinite, or too far from the offset.
  void run(std::uint64_t row, const std::byte* from, std::byte* to, std::size_t count) const;

  /// Returns a warning if coordinates were rounded to a grid that the user has stated or that is coarse, or if
  /// coordinates that stages have moved were rounded to the grid of the input; else an empty text.
  std::string rounding() const;

 private:
  void check_positions(std::uint64_t row, const std::byte* records, std::size_t count) const;
  [[noreturn]] void refuse(int axis, std::uint64_t row, double value) const;

  RecordConversion conversion_;
  PositionFields positions_;
  Vec3 scale_, offset_;
  std::size_t stride_in_, stride_out_;
  std::optional<Vec3> fitting_scale_;
  bool positions_change_, overlap_by_class_, moved_, notes_rounding_;
  mutable std::atomic<bool> rounds_ = false;  ///< true if a coordinate was not on the grid
  std::byte missing_returns_;
  std::string path_;
};

/// The base of the writers of LAS, LAZ and COPC.
class LasFamilyWriter : public Writer {
 protected:
  LasFamilyWriter(const OutputPlan& plan, LasPoints points);

  const LasHeader& header() const { return frame_.layout().header; }
  /// Encodes the next `count` records on all threads and adds the points to the statistics.
  void encode(const std::byte* from, std::byte* to, std::size_t count);
  /// Writes the chunk table of a compressed file at byte `at`, where the last chunk ends, and the offset of the table
  /// before the first chunk. Returns the byte after the table.
  std::uint64_t put_chunk_table(std::uint64_t at, std::span<const LazLayout::ChunkSize> chunks);
  /// Finishes the file like LasFrame::finish(), and warns of rounded coordinates.
  void finish_file(std::uint64_t points_end, std::span<const std::byte> last = {});

  LasFrame frame_;
  LasEncoder encoder_;
  LasStatistics statistics_;
};

}  // namespace pointsweep
