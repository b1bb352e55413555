// SPDX-License-Identifier: MIT
/// Records as they come into records of a LAS file.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "pointsweep/formats/las/las_layout.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

class LasEncoder {
 public:
  /// `path` is for the messages only.
  LasEncoder(const LasLayout& layout, std::string path);

  /// True if records need no change, so that they may be written as they come.
  bool is_identity() const { return conversion_.is_identity() && !positions_change_ && !returns_missing_; }
  std::size_t record_bytes_in() const { return stride_in_; }
  std::size_t record_bytes_out() const { return stride_out_; }

  /// Encodes `count` records; `row` is the number of the first. Thread-safe. Throws Error for coordinates that LAS
  /// cannot hold: NaN, infinite, or too far from the offset.
  void run(std::uint64_t row, const std::byte* from, std::byte* to, std::size_t count) const;

  /// A sentence about moved coordinates that were rounded; empty if none was.
  std::string rounding() const;

 private:
  void check_positions(std::uint64_t row, const std::byte* records, std::size_t count) const;
  [[noreturn]] void refuse(int axis, std::uint64_t row, double value) const;

  RecordConversion conversion_;
  PositionFields positions_;
  Vec3 scale_, offset_;
  std::size_t stride_in_, stride_out_;
  std::optional<Vec3> fitting_scale_;
  bool positions_change_, returns_missing_, notes_rounding_;
  mutable std::atomic<bool> rounds_ = false;  ///< a moved coordinate lay beside the grid
  std::byte only_return_;
  std::string path_;
};

}  // namespace pointsweep
