// SPDX-License-Identifier: MIT
/// The scans of a PTX file (Leica Geosystems), and the places of their points in the file.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "pointsweep/formats/files/line_reader.h"
#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {

/// A scan: a grid of cells; cell column * rows + row is at that column and row. A cell is a line `x y z [intensity [red
/// green blue]]`; 0 0 0 means that the scanner saw nothing.
struct PtxScan {
  std::uint64_t columns = 0, rows = 0;
  std::array<double, 16>
      matrix{};           ///< row by row, for row vectors: (x y z 1) * matrix is the point in the file's system
  std::size_t width = 0;  ///< numbers in the line of a cell: 3, 4 or 7

  std::uint64_t cells() const { return columns * rows; }
};

/// The place of a line with a cell.
struct PtxPlace {
  std::uint64_t offset = 0, line = 1;  ///< byte at which the line begins, and its number from 1
  std::uint64_t scan = 0, cell = 0;    ///< number of the scan, and of the cell in the scan, from 0
};

/// All scans, found by reading the file once, with the place of every 16,384th point.
struct PtxLayout {
  static constexpr std::uint64_t kPointsPerPlace = 16384;

  std::vector<PtxScan> scans;
  std::vector<PtxPlace> places;  ///< places of points 0, kPointsPerPlace, ...
  std::uint64_t points = 0;      ///< number of cells that are not empty
  std::uint64_t empty = 0;       ///< number of empty cells
  std::uint64_t end = 0;         ///< byte after the last point
};

/// Reads the whole file. Throws Error, with the line, for a wrong line in a header and a wrong first cell of a scan,
/// and if the file ends before the last cell. The numbers of other cells are not checked.
PtxLayout find_ptx_layout(const InputFile& file);

/// Returns whether a file that begins with `head` is a PTX file, by the ten lines of the header of its first scan.
bool starts_as_ptx(std::string_view head);

/// A cursor over the points.
class PtxCursor {
 public:
  /// Both arguments must outlive the cursor.
  PtxCursor(const InputFile& file, const PtxLayout& layout);

  /// Returns the line of point `point` < layout.points, valid until the next call. Fast for the point after the point
  /// returned last.
  std::string_view at(std::uint64_t point);
  /// Return the line number, the scan, and the cell in the scan of the point that at() returned last.
  std::uint64_t line() const { return lines_.line(); }
  std::uint64_t scan() const { return scan_; }
  std::uint64_t cell() const { return cell_ - 1; }

 private:
  std::string_view advance();
  std::string_view next_line();

  const PtxLayout* layout_;
  LineReader lines_;
  std::uint64_t next_;  ///< point that advance() returns next; layout_->points before the first call of at()
  std::uint64_t scan_ = 0, cell_ = 0;
};

}  // namespace pointsweep
