// SPDX-License-Identifier: MIT
/// The rows that a select keeps, one bit for each row: written in row order by a pass, then read by the cloud.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/formats/cloud/row_selection.h"
#include "pointsweep/order/row_file.h"

namespace pointsweep {

/// Collects a decision for each row of a cloud from which selects may have dropped rows. The result is a selection
/// among all rows of the cloud.
class RowMask {
 public:
  /// `before`: the rows that earlier selects have kept of `rows` rows; null: all. It must outlive the mask.
  RowMask(std::uint64_t rows, const RowSelection* before, const SpillPlace& spill);
  /// Appends the decisions about the next rows of `before`: not 0 for a kept row.
  void append(std::span<const std::uint8_t> kept);
  /// Returns the selection. Must be called after the last row.
  RowSelection finish();
  std::uint64_t spilled_bytes() const { return file_->spilled_bytes(); }

  /// Returns the selection of a finished mask that a checkpoint has stored at `kept`.
  static RowSelection kept(std::uint64_t rows, const SpillPlace& kept);
  /// Returns the bytes that a mask of `rows` rows takes, with 8 more for each block.
  static std::uint64_t bytes(std::uint64_t rows);

 private:
  void append_any(bool kept);

  std::uint64_t rows_, next_ = 0;  ///< number of all rows of the cloud, and of rows decided so far
  std::optional<SelectionCursor> before_;
  std::shared_ptr<RowFile> file_;
  std::vector<std::byte> block_;
};

}  // namespace pointsweep
