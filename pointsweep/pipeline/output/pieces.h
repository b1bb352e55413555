// SPDX-License-Identifier: MIT
/// Values that processes exchange through shared storage while they divide the points of a cloud among files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/pipeline/output/divider.h"
#include "pointsweep/storage/encoding.h"

namespace pointsweep {

/// The pieces of one range of rows: for each file, the number of its points in the range, in the order of the stored
/// records.
struct PiecesOfRange {
  std::vector<DividedFile> pieces;

  void encode(Encoder& out) const;
  static PiecesOfRange decode(Decoder& in);
};

/// Records [first, first + count) of a range, which belong to one file.
struct PieceOfFile {
  std::uint64_t range, first, count;
};

/// The files of all ranges together, in the order of their keys.
struct FilesOfRanges {
  std::vector<std::string> ranges;  ///< names under which the tasks of the ranges have stored their results
  std::vector<DividedFile> files;
  std::vector<std::vector<PieceOfFile>> pieces;  ///< pieces of each file, in the order of rows

  void encode(Encoder& out) const;
  static FilesOfRanges decode(Decoder& in);
  /// Returns the indices of the files that task `task` of `tasks` writes. The tasks get about equal numbers of points.
  std::vector<std::size_t> of_task(std::size_t task, std::size_t tasks) const;
};

/// Joins the pieces of all ranges. `names` and `pieces` have an element for each range, in the order of rows.
FilesOfRanges files_of(const std::vector<std::string>& names, std::span<const PiecesOfRange> pieces);

}  // namespace pointsweep
