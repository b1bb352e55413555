// SPDX-License-Identifier: MIT
/// Morphological opening of a raster by a disk: an erosion (the least value within the radius), then a dilation of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "pointsweep/raster/cell_rows.h"
#include "pointsweep/raster/disk.h"

namespace pointsweep {

enum class Opens : std::uint8_t {
  surface,   ///< marks cells above the opened surface, which goes on in place of the surface
  pit_marks  ///< marks cells below the opening of the surface upside down; the surface goes on unchanged
};

/// Marks a cell if it differs from the opened surface by more than `threshold`; earlier marks stay. Cells without a
/// value (kNoCell) count for nothing and stay so.
class OpenedRows final : public RowStream {
 public:
  OpenedRows(std::unique_ptr<RowStream> from, std::size_t radius, double threshold, Opens opens);
  bool next(CellRows& out) override;
  /// Memory for each column.
  static std::size_t column_bytes(std::size_t radius);

 private:
  static std::size_t most_held(std::size_t radius) { return 2 * (radius + kRowsAtOnce); }
  double turned(double value) const;
  void take_rows();
  void dilate();
  void give(std::size_t rows, CellRows& out);

  std::unique_ptr<RowStream> from_;
  double threshold_;
  bool upside_down_, ended_ = false;
  CellRows block_;
  std::vector<double> turned_;   ///< the rows that came, as they are opened
  CellRows held_;                ///< rows that came and are not given yet; `rows` of them
  std::size_t given_ = 0;        ///< rows given
  DiskMinima eroded_, dilated_;  ///< the second of negated values
};

}  // namespace pointsweep
